// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <cstdint>

#include "equidem/core/text.hpp"

#include "homogenize/homogenize.hpp"
#include "state_files.hpp"

namespace equidem {
namespace {

struct SpringKind {
  const char* name;
  const char* unit;  ///< in the names of columns
  std::vector<Matrix3> SpringSensitivities::*derivative;
  double (*of)(const ContactSprings& springs, std::size_t contact);
};

constexpr std::array spring_kinds{
    SpringKind{"kN", "Pa", &SpringSensitivities::by_kN, [](const ContactSprings& k, std::size_t c) { return k[c].kN; }},
    SpringKind{"kT", "Pa", &SpringSensitivities::by_kT, [](const ContactSprings& k, std::size_t c) { return k[c].kT; }},
    SpringKind{"kM", "N", &SpringSensitivities::by_kM,
               [](const ContactSprings& k, std::size_t c) { return k.bending(c); }}};

struct ModulusColumn {
  const char* name;
  const char *by_stiffness, *by_moment;  ///< units of derivatives by kN or kT, and by kM, in the names of columns
  double ModuliChange::*value;
};

constexpr std::array modulus_columns{ModulusColumn{"K", "", "_per_m2", &ModuliChange::bulk_modulus_2d},
                                     ModulusColumn{"G", "", "_per_m2", &ModuliChange::shear_modulus},
                                     ModulusColumn{"E", "", "_per_m2", &ModuliChange::young_modulus},
                                     ModulusColumn{"nu", "_per_Pa", "_per_N", &ModuliChange::poisson_ratio}};

/// The changes of the moduli per relative change of all springs of a kind.
ModuliChange change_by_all(const SpringKind& kind, const ContactSprings& springs, const Matrix3& stiffness,
                           const SpringSensitivities& found) {
  Matrix3 sum{};
  const std::vector<Matrix3>& each = found.*kind.derivative;
  for (std::size_t c = 0; c < each.size(); ++c) sum = sum + kind.of(springs, c) * each[c];
  return change_of_moduli(stiffness, sum);
}

/// Relative changes of K, G and E, the change of nu, as a row of the table and in the JSON.
Results changes_of(const std::string& name, const EffectiveModuli& m, const ModuliChange& change) {
  constexpr Shown shown{Shown::decimals, 5};
  return Results()
      .add("", "springs", "  " + name)
      .add("bulk_modulus_2d", "dK/K", change.bulk_modulus_2d / m.bulk_modulus_2d, "", shown)
      .add("shear_modulus", "dG/G", change.shear_modulus / m.shear_modulus, "", shown)
      .add("young_modulus", "dE/E", change.young_modulus / m.young_stress, "", shown)
      .add("poisson_ratio", "dnu", change.poisson_ratio, "", shown);
}

/// Adds the changes by one common factor of the springs of each pair of groups, and their scatter where these factors
/// scatter independently.
void add_pairs(std::vector<Results>& rows, Results& of_kinds, const Problem& problem, const Matrix3& stiffness,
               const SpringSensitivities& found) {
  const auto& pairs = problem.resolved.springs_between;
  if (pairs.empty()) return;
  const EffectiveModuli moduli = effective_moduli(stiffness);
  const Materials materials(problem.assembly, pairs);
  std::vector<Matrix3> sums(pairs.size() + 1);
  for (std::size_t c = 0; c < problem.assembly.contacts.size(); ++c) {
    Matrix3& sum = sums[materials.pair_of(c).value_or(pairs.size())];
    sum = sum + change_by_springs(problem.springs.springs, found, c);
  }
  std::vector<Results> by_pair;
  std::vector<ModuliChange> changes;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    changes.push_back(change_of_moduli(stiffness, sums[k]));
    const std::string name = k < pairs.size() ? name_of(pairs[k]) : "other contacts";
    rows.push_back(changes_of(name, moduli, changes.back()));
    by_pair.push_back(Results().set("springs", name).append(rows.back()));
  }
  const auto root_of_squares = [&](double ModuliChange::*change) {
    double sum = 0;
    for (const ModuliChange& of_pair : changes) sum += of_pair.*change * (of_pair.*change);
    return std::sqrt(sum);
  };
  rows.push_back(
      changes_of("each of these, scattering", moduli,
                 {root_of_squares(&ModuliChange::bulk_modulus_2d), root_of_squares(&ModuliChange::shear_modulus),
                  root_of_squares(&ModuliChange::young_modulus), root_of_squares(&ModuliChange::poisson_ratio)}));
  of_kinds.set("pairs", std::move(by_pair)).set("scatter_of_pairs", rows.back());
}

}  // namespace

Results spring_effects(const Problem& problem, const Matrix3& stiffness, const SpringSensitivities& found) {
  const ContactSprings& springs = problem.springs.springs;
  const EffectiveModuli moduli = effective_moduli(stiffness);
  std::vector<Results> rows;
  Results of_kinds;
  for (const SpringKind& kind : spring_kinds) {
    if ((found.*kind.derivative).empty()) continue;
    rows.push_back(changes_of("all " + std::string(kind.name), moduli, change_by_all(kind, springs, stiffness, found)));
    of_kinds.set(kind.name, rows.back());
  }
  rows.push_back(changes_of("each contact, scattering", moduli, scatter_of_moduli(springs, stiffness, found)));
  of_kinds.set("scatter", rows.back());
  add_pairs(rows, of_kinds, problem, stiffness, found);
  Results out;
  out.block(
         "\nchanges of the moduli (plane stress) per relative change of all springs of a kind; standard deviations "
         "per\n"
         "coefficient of variation of springs that scatter independently, contact by contact or pair by pair, to "
         "first\n"
         "order\n")
      .table("", rows);
  return out.set("sensitivities", of_kinds);
}

namespace {

Table sensitivity_table(const Problem& problem, const Matrix3& stiffness, const SpringSensitivities& found) {
  const std::vector<Contact>& contacts = problem.assembly.contacts;
  const ContactSprings& springs = problem.springs.springs;
  std::vector<std::int64_t> numbers(contacts.size());
  for (std::size_t c = 0; c < numbers.size(); ++c) numbers[c] = static_cast<std::int64_t>(c);
  Table table;
  table.add("contact", numbers).add("i", contacts, &Contact::i).add("j", contacts, &Contact::j);
  const auto each_kind = [&](const auto& visit) {
    for (const SpringKind& kind : spring_kinds)
      if (!(found.*kind.derivative).empty()) visit(kind, found.*kind.derivative);
  };
  each_kind([&](const SpringKind& kind, const auto&) {
    table.add(fmt::format("{}_{}", kind.name, kind.unit), numbers,
              [&](std::int64_t c) { return kind.of(springs, static_cast<std::size_t>(c)); });
  });
  each_kind([&](const SpringKind& kind, const std::vector<Matrix3>& derivatives) {
    for (const ModulusColumn& modulus : modulus_columns) {
      const bool moment = kind.derivative == &SpringSensitivities::by_kM;
      table.add(fmt::format("d{}_d{}{}", modulus.name, kind.name, moment ? modulus.by_moment : modulus.by_stiffness),
                derivatives, [&](const Matrix3& change) { return change_of_moduli(stiffness, change).*modulus.value; });
    }
  });
  return table;
}

/// A picture: the change of a modulus by all springs of a contact, of E and G relative.
struct EffectPicture {
  const char* suffix;
  const char* symbol;
  const char* legend;
  double ModuliChange::*change;
  double EffectiveModuli::*whole;  ///< null: the change itself is drawn
};

constexpr std::array effect_pictures{
    EffectPicture{"_effect_on_E", "E", "dE/E by the springs of a contact; widest line ", &ModuliChange::young_modulus,
                  &EffectiveModuli::young_stress},
    EffectPicture{"_effect_on_G", "G", "dG/G by the springs of a contact; widest line ", &ModuliChange::shear_modulus,
                  &EffectiveModuli::shear_modulus},
    EffectPicture{"_effect_on_nu", "nu", "dnu by the springs of a contact, red: up, blue: down; widest line ",
                  &ModuliChange::poisson_ratio, nullptr}};

}  // namespace

std::vector<std::string> files_of_sensitivities(const OutputCase& wanted) {
  std::vector<std::string> names{sensitivities_name};
  for (const EffectPicture& picture : effect_pictures)
    for (const std::string& name : state_names(pictures_of(wanted), picture.suffix)) names.push_back(name);
  return names;
}

void write_sensitivities(const CommonOptions& options, const Problem& problem, const Matrix3& stiffness,
                         const SpringSensitivities& found) {
  if (!options.pictures_only)
    write_csv(*options.out / sensitivities_name, sensitivity_table(problem, stiffness, found), true);
  const ContactSprings& springs = problem.springs.springs;
  const EffectiveModuli moduli = effective_moduli(stiffness);
  for (const EffectPicture& picture : effect_pictures) {
    std::vector<ContactForce> lines(found.by_kN.size());
    for (std::size_t c = 0; c < lines.size(); ++c)
      lines[c].normal = change_of_moduli(stiffness, change_by_springs(springs, found, c)).*picture.change /
                        (picture.whole == nullptr ? 1 : moduli.*picture.whole);
    const std::string& title = problem.resolved.title;
    write_state_picture(options, problem.resolved.output, picture.suffix,
                        {.assembly = problem.assembly, .contact_forces = lines},
                        {.title = fmt::format("{}{}what the springs of each contact do to {}", title,
                                              title.empty() ? "" : ": ", picture.symbol),
                         .lines = picture.legend,
                         .unit_of_lines = ""});
  }
}

std::vector<ResultArray> sensitivity_arrays(const std::shared_ptr<const SpringSensitivities>& found) {
  std::vector<ResultArray> arrays;
  for (const SpringKind& kind : spring_kinds) {
    const std::vector<Matrix3>& derivatives = *found.*kind.derivative;
    if (derivatives.empty()) continue;
    const bool bending = kind.derivative == &SpringSensitivities::by_kM;
    arrays.push_back(array_of(fmt::format("dC_d{}", kind.name), bending ? "1/m2" : "",
                              std::shared_ptr<const std::vector<Matrix3>>(found, &derivatives), 9));
    arrays.back().matrix_columns = 3;
  }
  return arrays;
}

std::vector<ResultArray> shape_arrays(const ShapeSensitivities& found) {
  std::vector<Matrix3> by_x, by_y;
  for (const auto& [x, y] : found.by_position) by_x.push_back(x), by_y.push_back(y);
  std::vector<ResultArray> arrays;
  const auto add = [&](const char* name, std::vector<Matrix3> derivatives) {
    if (derivatives.empty()) return;
    arrays.push_back(array_of(name, "Pa/m", std::move(derivatives), 9));
    arrays.back().matrix_columns = 3;
  };
  add("dC_dx", std::move(by_x));
  add("dC_dy", std::move(by_y));
  add("dC_dradius", found.by_radius);
  return arrays;
}

}  // namespace equidem
