// SPDX-License-Identifier: GPL-3.0-or-later
#include "spring_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"

#include "state_files.hpp"

namespace equidem {
namespace {

struct SpringKind {
  const char* name;
  const char* unit;  ///< in the names of columns
  std::vector<double> SpringDerivatives::*derivative;
  double (*of)(const ContactSprings& springs, std::size_t contact);
};

constexpr std::array spring_kinds{
    SpringKind{"kN", "Pa", &SpringDerivatives::by_kN, [](const ContactSprings& k, std::size_t c) { return k[c].kN; }},
    SpringKind{"kT", "Pa", &SpringDerivatives::by_kT, [](const ContactSprings& k, std::size_t c) { return k[c].kT; }},
    SpringKind{"kM", "N", &SpringDerivatives::by_kM,
               [](const ContactSprings& k, std::size_t c) { return k.bending(c); }}};

constexpr double no_derivative = std::numeric_limits<double>::quiet_NaN();

bool any(std::span<const SpringDependent> numbers, const SpringKind& kind) {
  return std::ranges::any_of(numbers,
                             [&](const SpringDependent& number) { return !(number.*kind.derivative).empty(); });
}

/// The unit of a derivative, Pa over N in 1/m².
std::string unit_of(const SpringDependent& number, const SpringKind& kind) {
  if (number.unit == "Pa") return std::string_view(kind.unit) == "Pa" ? "" : "1/m2";
  return fmt::format("{}/{}", number.unit.empty() ? "1" : number.unit, kind.unit);
}

/// As the end of the name of a column.
std::string suffix(const SpringDependent& number, const SpringKind& kind) {
  std::string text;
  for (const char letter : unit_of(number, kind)) text += letter == '/' ? "_per_" : std::string(1, letter);
  if (text.starts_with('1')) text.erase(0, 1);
  return text.empty() || text.starts_with('_') ? text : "_" + text;
}

double change_by_all(const SpringDependent& number, const SpringKind& kind, const ContactSprings& springs) {
  const std::vector<double>& each = number.*kind.derivative;
  double sum = each.empty() ? no_derivative : 0;
  for (std::size_t c = 0; c < each.size(); ++c) sum += kind.of(springs, c) * each[c];
  return sum;
}

/// A row of the table and of the JSON. \param changes one for each number, NaN: none
Results row_of(const std::string& name, std::span<const SpringDependent> numbers, const std::vector<double>& changes) {
  constexpr std::size_t most_of_list = 3;  // a report is 110 columns wide
  Results row;
  row.add("", "springs", "  " + name);
  for (std::size_t k = 0; k < numbers.size();) {
    const std::size_t first = k;
    const std::string& key = numbers[first].key;
    std::vector<double> values;
    for (; k < numbers.size() && numbers[k].key == key; ++k) {
      values.push_back(changes[k] / numbers[k].whole);
      if (k - first < most_of_list && !std::isnan(values.back()))
        row.add("", numbers[k].heading, values.back(), "", {Shown::decimals, 5});
    }
    if (numbers[first].listed) {
      row.set(key, values);
    } else {
      row.set(key, std::isnan(values.front()) ? ResultValue(nullptr) : ResultValue(values.front()));
    }
  }
  return row;
}

/// Adds the changes by one common factor of the springs of each pair of groups, and their scatter where these factors
/// scatter independently.
void add_pairs(std::vector<Results>& rows, Results& of_kinds, const Problem& problem,
               std::span<const SpringDependent> numbers) {
  const auto& pairs = problem.resolved.springs_between;
  if (pairs.empty()) return;
  const Materials materials(problem.assembly, pairs);
  std::vector<std::vector<double>> changes(pairs.size() + 1, std::vector<double>(numbers.size()));
  for (std::size_t c = 0; c < problem.assembly.contacts.size(); ++c) {
    std::vector<double>& sums = changes[materials.pair_of(c).value_or(pairs.size())];
    for (std::size_t k = 0; k < numbers.size(); ++k)
      sums[k] += numbers[k].by_kN.empty() ? no_derivative : numbers[k].change_by(problem.springs.springs, c);
  }
  std::vector<Results> by_pair;
  std::vector<double> scatter(numbers.size());
  for (std::size_t p = 0; p < changes.size(); ++p) {
    const std::string name = p < pairs.size() ? name_of(pairs[p]) : "other contacts";
    rows.push_back(row_of(name, numbers, changes[p]));
    by_pair.push_back(Results().set("springs", name).append(rows.back()));
    for (std::size_t k = 0; k < numbers.size(); ++k) scatter[k] = std::hypot(scatter[k], changes[p][k]);
  }
  rows.push_back(row_of("each of these, scattering", numbers, scatter));
  of_kinds.set("pairs", std::move(by_pair)).set("scatter_of_pairs", rows.back());
}

}  // namespace

Results spring_effects(const Problem& problem, std::span<const SpringDependent> numbers, const std::string& of_what) {
  const ContactSprings& springs = problem.springs.springs;
  std::vector<Results> rows;
  Results of_kinds;
  std::vector<double> changes(numbers.size());
  for (const SpringKind& kind : spring_kinds) {
    if (!any(numbers, kind)) continue;
    for (std::size_t k = 0; k < numbers.size(); ++k) changes[k] = change_by_all(numbers[k], kind, springs);
    rows.push_back(row_of("all " + std::string(kind.name), numbers, changes));
    of_kinds.set(kind.name, rows.back());
  }
  for (std::size_t k = 0; k < numbers.size(); ++k)
    changes[k] = numbers[k].by_kN.empty() ? no_derivative : numbers[k].scatter(springs);
  rows.push_back(row_of("each contact, scattering", numbers, changes));
  of_kinds.set("scatter", rows.back());
  add_pairs(rows, of_kinds, problem, numbers);
  Results out;
  out.block(
         "\n" + of_what +
         "\nper relative change of all springs of a kind; standard deviations per coefficient of variation of springs"
         "\nthat scatter independently, contact by contact or pair by pair, to first order\n")
      .table("", rows);
  return out.set("sensitivities", of_kinds);
}

namespace {

Table sensitivity_table(const Problem& problem, std::span<const SpringDependent> numbers) {
  const std::vector<Contact>& contacts = problem.assembly.contacts;
  const ContactSprings& springs = problem.springs.springs;
  std::vector<std::int64_t> rows(contacts.size());
  for (std::size_t c = 0; c < rows.size(); ++c) rows[c] = static_cast<std::int64_t>(c);
  Table table;
  table.add("contact", rows).add("i", contacts, &Contact::i).add("j", contacts, &Contact::j);
  for (const SpringKind& kind : spring_kinds) {
    if (any(numbers, kind))
      table.add(fmt::format("{}_{}", kind.name, kind.unit), rows,
                [&](std::int64_t c) { return kind.of(springs, static_cast<std::size_t>(c)); });
  }
  for (const SpringKind& kind : spring_kinds) {
    for (const SpringDependent& number : numbers)
      if (const auto& derivatives = number.*kind.derivative; !derivatives.empty())
        table.add(fmt::format("d{}_d{}{}", number.symbol, kind.name, suffix(number, kind)), derivatives);
  }
  return table;
}

std::string sensitivity_table_name(const std::string& case_suffix) {
  return "sensitivities" + case_suffix + ".csv";
}

std::string picture_suffix(const std::string& case_suffix, const std::string& symbol) {
  return case_suffix + "_effect_on_" + symbol;
}

}  // namespace

std::vector<std::string> files_of_sensitivities(const OutputCase& wanted, std::span<const std::string> pictures,
                                                const std::string& case_suffix) {
  std::vector<std::string> names{sensitivity_table_name(case_suffix)};
  for (const std::string& symbol : pictures)
    std::ranges::move(state_names(pictures_of(wanted), picture_suffix(case_suffix, symbol)), std::back_inserter(names));
  return names;
}

void write_sensitivities(const CommonOptions& options, const Problem& problem, std::span<const SpringDependent> numbers,
                         const std::string& case_suffix) {
  if (!options.pictures_only)
    write_csv(*options.out / sensitivity_table_name(case_suffix), sensitivity_table(problem, numbers), true);
  const ContactSprings& springs = problem.springs.springs;
  for (const SpringDependent& number : numbers) {
    if (!number.drawn || number.by_kN.empty()) continue;
    std::vector<ContactForce> lines(number.by_kN.size());
    for (std::size_t c = 0; c < lines.size(); ++c) lines[c].normal = number.change_by(springs, c) / number.whole;
    const std::string& title = problem.resolved.title;
    write_state_picture(options, problem.resolved.output, picture_suffix(case_suffix, number.symbol),
                        {.assembly = problem.assembly, .contact_forces = lines},
                        {.title = fmt::format("{}{}what the springs of each contact do to {}", title,
                                              title.empty() ? "" : ": ", number.symbol),
                         .lines = number.heading + " by the springs of a contact, red: up, blue: down; widest line ",
                         .unit_of_lines = ""});
  }
}

double bytes_of_sensitivities(const Problem& problem, double numbers) {
  const double kinds = problem.springs.springs.bends() ? 3 : 2;
  const Assembly& assembly = problem.assembly;
  return numbers * kinds * sizeof(double) * static_cast<double>(assembly.contacts.size()) /
         static_cast<double>(assembly.size());
}

std::vector<ResultArray> sensitivity_arrays(std::span<const SpringDependent> numbers, const std::string& prefix) {
  std::vector<ResultArray> arrays;
  for (std::size_t first = 0, last = 0; first < numbers.size(); first = last) {
    while (last < numbers.size() && numbers[last].key == numbers[first].key) ++last;
    const std::span<const SpringDependent> list = numbers.subspan(first, last - first);
    for (const SpringKind& kind : spring_kinds) {
      if (!any(list, kind)) continue;
      std::size_t contacts = 0;
      for (const SpringDependent& number : list) contacts = std::max(contacts, (number.*kind.derivative).size());
      std::vector<double> values(contacts * list.size(), no_derivative);
      for (std::size_t k = 0; k < list.size(); ++k) {
        const std::vector<double>& each = list[k].*kind.derivative;
        for (std::size_t c = 0; c < each.size(); ++c) values[c * list.size() + k] = each[c];
      }
      ResultArray array = array_of(
          fmt::format("{}d{}_d{}", prefix, list.front().listed ? list.front().key : list.front().symbol, kind.name),
          unit_of(list.front(), kind), std::move(values), 1);
      array.rows = contacts, array.columns = array.stride = list.size();
      arrays.push_back(std::move(array));
    }
  }
  return arrays;
}

}  // namespace equidem
