// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/page/answers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "equidem/core/text.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/quantities.hpp"

namespace equidem {
namespace {

/// A number of a result by its path (find_result); '*' stands for every position of a list or every key of an object.
struct AnswerKey {
  const char* path;
  const char* label;
  const char* error = "";  ///< path of its error
};

struct AnswersOfVerb {
  std::string_view verb;
  std::vector<AnswerKey> main;  ///< the first four that are known are shown
  std::vector<AnswerKey> quality;
};

const std::vector<AnswersOfVerb>& all_answers() {
  static const std::vector<AnswersOfVerb> all{
      {"solve",
       {{"poisson_ratio", "Poisson's ratio, plane strain"},
        {"plane_strain/young_modulus", "Young's modulus, plane strain"},
        {"stiffness_ratio", "2G/((1-ν) kN)"},
        {"energy", "strain energy"},
        {"load_cases/*/energy", "strain energy"},
        {"largest_deformation", "largest change of a contact, of the sum of the radii"}},
       {{"relative_residual", "residual, relative"},
        {"error_bound", "error bound of the motions, relative"},
        {"load_cases/*/relative_residual", "residual, relative"},
        {"load_cases/*/error_bound", "error bound of the motions, relative"},
        {"theory/poisson_ratio", "Poisson's ratio by theory"},
        {"condition", "condition of the stiffness matrix, about"}}},
      {"homogenize",
       {{"young_modulus/plane_strain", "Young's modulus, plane strain", "error_bound"},
        {"poisson_ratio/plane_strain", "Poisson's ratio, plane strain"},
        {"shear_modulus", "shear modulus", "error_bound"},
        {"bulk_modulus_2d", "bulk modulus, two-dimensional", "error_bound"},
        {"ensemble/$/young_modulus/plane_strain/mean", "Young's modulus, plane strain, mean of the largest cells",
         "ensemble/$/young_modulus/plane_strain/standard_error"},
        {"ensemble/$/poisson_ratio/plane_strain/mean", "Poisson's ratio, plane strain, mean of the largest cells",
         "ensemble/$/poisson_ratio/plane_strain/standard_error"},
        {"ensemble/$/shear_modulus/mean", "shear modulus, mean of the largest cells",
         "ensemble/$/shear_modulus/standard_error"},
        {"ensemble/$/bulk_modulus_2d/mean", "bulk modulus, two-dimensional, mean of the largest cells",
         "ensemble/$/bulk_modulus_2d/standard_error"}},
       {{"relative_residual", "residual, relative"},
        {"error_bound", "error bound of an entry of the stiffness"},
        {"anisotropy", "anisotropy"},
        {"condition", "condition of the stiffness matrix, about"},
        {"ensemble/$/discs", "discs of the largest cells"},
        {"ensemble/$/samples", "number of the largest cells"}}},
      {"calibrate",
       {{"kN", "normal spring kN"},
        {"kT", "tangential spring kT"},
        {"ratio", "kT/kN"},
        {"density", "density of the discs"}},
       {{"achieved/poisson_ratio/plane_strain", "Poisson's ratio reached, plane strain"},
        {"achieved/young_modulus/plane_strain", "Young's modulus reached, plane strain"},
        {"feasible_poisson_ratios/plane_strain", "feasible Poisson's ratios, plane strain"},
        {"feasible_poisson_ratios/plane_stress", "feasible Poisson's ratios, plane stress"}}},
      {"stability",
       {{"critical_ratio", "critical kT/kN"},
        {"ratio", "kT/kN of this case"},
        {"critical_time_step", "critical time step"},
        {"longest_period", "longest period"}},
       {{"growth_rate", "growth of a disturbance"},
        {"element_bound_time_step", "time step that is guaranteed to be stable"},
        {"omega_max_squared_residual", "residual of ω² of the highest frequency"},
        {"unstable_modes", "unstable modes"},
        {"zero_energy_modes", "zero-energy modes"}}},
      {"pack",
       {{"solid_fraction", "solid fraction"},
        {"coordination_number", "contacts of a body"},
        {"void_ratio", "void ratio"},
        {"bonds", "bonds of the assembly"}},
       {{"largest_overlap", "largest overlap, of the smaller radius"},
        {"unbalanced_force_ratio", "unbalanced force, of the mean contact force"},
        {"energy_error", "error of the energy balance, of the energy lost"},
        {"rattlers", "rattlers"}}},
      {"quasistatic",
       {{"peak/load", "largest load"},
        {"first_break/lambda", "λ of the first break"},
        {"event_count", "contacts broken"},
        {"energies/released", "energy released"}},
       {{"relative_residual", "largest residual of a state, relative"},
        {"energies/error", "error of the energy balance, relative"},
        {"unstable_states", "states with unstable modes"},
        {"tied_events", "contacts that broke at the same λ as others"}}},
      {"run",
       {{"waves/*/speed", "wave speed"},
        {"poisson_ratio", "Poisson's ratio, plane strain"},
        {"plane_strain/young_modulus", "Young's modulus, plane strain"},
        {"stiffness_ratio", "2G/((1-ν) kN)"},
        {"settlement", "settlement of the surface"},
        {"void_ratio/after", "void ratio at the end"},
        {"energy/kinetic", "kinetic energy at the end"},
        {"energy/elastic", "elastic energy at the end"},
        {"energy/dissipated", "energy lost"},
        {"time", "time simulated"}},
       {{"relative_unbalanced_force", "unbalanced force, relative"},
        {"energy/relative_error", "error of the energy balance, relative"},
        {"largest_deformation", "largest change of a contact, of the sum of the radii"},
        {"time_step", "time step"},
        {"contacts", "contacts"},
        {"steps", "steps"}}},
      {"sweep", {{"points", "points"}}, {}},
      {"study",
       {{"settings", "settings"}, {"orders/*/observed_order", "order of the error"}},
       {{"rounds", "rounds of timing"}}}};
  return all;
}

const AnswersOfVerb* answers_listed(std::string_view verb) {
  const auto found = std::ranges::find(all_answers(), verb, &AnswersOfVerb::verb);
  return found == all_answers().end() ? nullptr : &*found;
}

/// Paths in which names or positions stand for the '*', each with the name.
std::vector<std::pair<std::string, std::string>> expanded(const Results& results, const std::string& path) {
  const std::size_t star = path.find('*');
  if (star == std::string::npos) return {{path, ""}};
  std::vector<std::pair<std::string, std::string>> all;
  const std::string before = path.substr(0, star - 1), after = path.substr(star + 1);
  for (const Result& part : results.parts()) {
    if (part.key.starts_with(before + "/") && part.key.ends_with(after)) {
      const std::string name = part.key.substr(star, part.key.size() - star - after.size());
      if (name.find('/') == std::string::npos) all.emplace_back(part.key, name);
    }
    const auto* list = std::get_if<std::shared_ptr<const std::vector<Results>>>(&part.value.value);
    if (part.key != before || list == nullptr) continue;
    for (std::size_t k = 0; k < (*list)->size(); ++k) {
      const Result* named = find_result((**list)[k], "case");
      const auto* name = named != nullptr ? std::get_if<std::string>(&named->value.value) : nullptr;
      all.emplace_back(fmt::format("{}/{}{}", before, k, after), name != nullptr ? *name : "");
    }
  }
  return all;
}

std::optional<double> number_of(const Results& results, const std::string& path) {
  const Result* found = path.empty() ? nullptr : find_result(results, path);
  if (found == nullptr) return std::nullopt;
  const auto& value = found->value.value;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* list = std::get_if<std::shared_ptr<const std::vector<Results>>>(&value))
    return static_cast<double>((*list)->size());
  return std::nullopt;
}

/// The unit of a number in result.json.
std::string unit_of(const Results& units, const std::string& path) {
  std::string name;
  for (const std::string_view word : parts_of(path, '/')) {
    const bool position =
        word == "$" || (!word.empty() && word.find_first_not_of("0123456789") == std::string_view::npos);
    if (!position) name += fmt::format("{}{}", name.empty() ? "" : ".", word);
  }
  for (const Result& unit : units.parts())
    if (unit.key == name)
      if (const auto* text = std::get_if<std::string>(&unit.value.value)) return *text;
  return "";
}

/// Factor and name of the unit in which the value lies between 1 and 1000.
std::pair<double, std::string> prefixed(double value, const std::string& unit) {
  constexpr std::array<const char*, 9> prefixes{"p", "n", "µ", "m", "", "k", "M", "G", "T"};
  constexpr std::array<std::string_view, 5> scalable{"Pa", "s", "J", "J/m", "Hz"};
  if (value == 0 || std::ranges::find(scalable, unit) == scalable.end()) return {1, unit};
  const int power = static_cast<int>(std::floor(std::log10(std::abs(value)) / 3));
  if (power < -4 || power > 4) return {1, unit};
  return {std::pow(1000.0, power), prefixes[static_cast<std::size_t>(power + 4)] + unit};
}

std::string range_html(const std::vector<double>& values, int digits) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number_html(value, digits));
  return joined(texts, values.size() == 2 ? " to " : ", ");
}

std::vector<Answer> shown(const Results& results, const Results& units, std::span<const AnswerKey> keys, int digits) {
  std::vector<Answer> answers;
  for (const AnswerKey& key : keys) {
    for (const auto& [path, name] : expanded(results, key.path)) {
      Answer answer{.label = name.empty() ? key.label : fmt::format("{}, {}", key.label, name), .text = {}};
      if (const Result* found = find_result(results, path)) {
        if (const auto* range = std::get_if<std::vector<double>>(&found->value.value)) {
          answer.text = range_html(*range, digits);
          answer.value = range->empty() ? 0 : range->front();
          answers.push_back(answer);
          continue;
        }
      }
      const auto value = number_of(results, path);
      if (!value || !std::isfinite(*value)) continue;
      const std::string unit = unit_of(units, path);
      const auto [factor, name_of_unit] = prefixed(*value, unit);
      answer.value = *value;
      const bool whole = std::floor(*value) == *value && std::abs(*value) < 1e9 && unit.empty();
      answer.text = whole ? grouped(static_cast<std::int64_t>(*value)) : number_html(*value / factor, digits);
      answer.unit = name_of_unit;
      if (const auto error = number_of(results, key.error); error && std::isfinite(*error)) {
        const auto [small, unit_of_error] = prefixed(*error, unit);
        answer.error = fmt::format("± {} {}", number_html(*error / small, 2), escape_xml(unit_of_error));
      }
      answers.push_back(std::move(answer));
    }
  }
  return answers;
}

}  // namespace

bool has_page(std::string_view verb) {
  return answers_listed(verb) != nullptr;
}

Answers answers_of(std::string_view verb, const Results& results) {
  const AnswersOfVerb* keys = answers_listed(verb);
  if (keys == nullptr) return {};
  constexpr std::size_t most = 4;
  const Results described = units_and_labels(results);
  const Result* const found = find_result(described, "units");
  const auto* units = found != nullptr ? std::get_if<std::shared_ptr<const Results>>(&found->value.value) : nullptr;
  const Results none;
  const Results& known = units != nullptr ? **units : none;
  Answers answers{shown(results, known, keys->main, 6), shown(results, known, keys->quality, 4)};
  if (answers.main.size() > most) answers.main.resize(most);
  return answers;
}

std::string number_html(double value, int digits) {
  const std::string text = fmt::format("{:.{}g}", value, digits);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) {
    const bool negative = text.starts_with('-');
    return negative ? "−" + text.substr(1) : text;
  }
  std::string exponent = text.substr(e + 1);
  const bool negative = exponent.starts_with('-');
  exponent.erase(0, exponent.find_first_not_of("+-0"));
  const std::string mantissa = text.substr(0, e);
  return fmt::format("{}{} × 10<sup>{}{}</sup>", mantissa.starts_with('-') ? "−" : "",
                     mantissa.starts_with('-') ? mantissa.substr(1) : mantissa, negative ? "−" : "", exponent);
}

namespace {

using enum TrustCheck::Verdict;

std::optional<double> number(const Results& results, const char* path) {
  const Result* found = find_result(results, path);
  const auto* value = found != nullptr ? std::get_if<double>(&found->value.value) : nullptr;
  return value != nullptr && std::isfinite(*value) ? std::optional(*value) : std::nullopt;
}

/// Good up to the first limit, doubtful up to the second.
TrustCheck graded(std::string name, double value, std::pair<double, double> limits, std::string found,
                  std::string advice) {
  const auto verdict = value <= limits.first ? good : value <= limits.second ? doubtful : bad;
  return {verdict, std::move(name), std::move(found), verdict == good ? "" : std::move(advice)};
}

std::optional<TrustCheck> check_step(const Results& results, const TrustLimits& limits) {
  const auto step = number(results, "time_step");
  if (!step) return std::nullopt;
  if (const auto ratio = number(results, "time_step_ratio")) {
    const auto* exact = find_result(results, "critical_time_step_exact");
    const bool critical =
        exact != nullptr && std::get_if<bool>(&exact->value.value) != nullptr && std::get<bool>(exact->value.value);
    return graded("time step", *ratio, {1, 1},
                  fmt::format("{:.3g} of the {} step", *ratio, critical ? "critical" : "guaranteed"),
                  "Leave run.time_step out, or give a shorter one: beyond the critical step the motion grows");
  }
  if (const auto critical = number(results, "critical_time_step")) {
    return graded("time step", *step / *critical, {limits.safe_step_of_contact, 1},
                  fmt::format("{:.3g} of the critical step of one contact", *step / *critical),
                  "Compare with a run.time_step a third as long: several contacts at a body lower the critical step");
  }
  if (const auto contact = number(results, "steps_in_contact"))
    return TrustCheck{good, "time step",
                      fmt::format("{:.3g} steps in the shortest contact, exact at any step", *contact)};
  if (find_result(results, "time_step_ratio") != nullptr)
    return TrustCheck{good, "time step", "nothing vibrates, any step is stable"};
  return TrustCheck{doubtful, "time step", "the duration of a contact is not known",
                    "Give collisions.closing_speed, or compare with a run.time_step half as long"};
}

std::optional<TrustCheck> check_overlap(const Results& results, const TrustLimits& limits) {
  const std::pair graded_by{limits.small_overlap, limits.large_overlap};
  if (const auto change = number(results, "largest_deformation")) {
    return graded("overlap", *change, graded_by,
                  fmt::format("contacts change by at most {:.2g} of the sum of their radii", *change),
                  "Take stiffer springs or smaller loads: the contact law is that of small overlaps");
  }
  if (find_result(results, "grains") == nullptr) return std::nullopt;
  const auto overlap = number(results, "largest_overlap");
  if (!overlap) return TrustCheck{good, "overlap", "no bodies touch at the end"};
  return graded("overlap", *overlap, graded_by,
                fmt::format("at most {:.2g} of the smaller radius at the end", *overlap),
                "Take a shorter collisions.contact_duration or a larger stiffness: bodies overlap visibly");
}

std::optional<TrustCheck> check_balance(const Results& results, const TrustLimits& limits) {
  if (const auto force = number(results, "relative_unbalanced_force")) {
    return graded("balance of forces", *force, {limits.small_unbalanced_force, limits.large_unbalanced_force},
                  fmt::format("unbalanced by {:.1e} of the contact forces", *force), "Give a smaller run.until_rest");
  }
  const auto error = number(results, "energy/relative_error");
  if (!error) return std::nullopt;
  return graded("balance of energies", std::abs(*error), {limits.small_imbalance, limits.large_imbalance},
                fmt::format("closed to {:.1e} of the largest energy", std::abs(*error)),
                "Compare with a shorter run.time_step before trusting the motion");
}

/// The mean field of bonded discs, nu = (1 - kT/kN)/4 in plane strain (Abe 1996, eq. 35), is at most 1/4 without
/// negative springs, 1/3 in plane stress.
std::optional<TrustCheck> check_poisson_ratio(const Results& results) {
  const auto ratio = number(results, "springs/ratio");
  if (!ratio || find_result(results, "grains") != nullptr) return std::nullopt;
  if (*ratio >= 0)
    return TrustCheck{good, "Poisson's ratio", fmt::format("feasible: no spring is negative (kT/kN = {:.4g})", *ratio)};
  return TrustCheck{bad, "Poisson's ratio", fmt::format("not feasible in motion: kT/kN = {:.4g} is negative", *ratio),
                    "Ask for at most 1/4 in plane strain, 1/3 in plane stress: 'equidem calibrate' tells the range of "
                    "an assembly"};
}

}  // namespace

std::vector<TrustCheck> trust_checks(const Results& results, const TrustLimits& limits) {
  std::vector<TrustCheck> checks;
  for (auto& check : {check_step(results, limits), check_overlap(results, limits), check_balance(results, limits),
                      check_poisson_ratio(results)})
    if (check) checks.push_back(*check);
  return checks;
}

}  // namespace equidem
