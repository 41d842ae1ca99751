// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/quantities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/texts.hpp"

namespace equidem {

namespace {

const std::set<std::string>& unit_symbols() {
  static const std::set<std::string> all = [] {
    std::set<std::string> found{"J", "J/m"};  // of energies, by the kind of bodies
    for (const ResultQuantity& quantity : result_quantities())
      if (!quantity.unit.empty()) found.insert(quantity.unit);
    return found;
  }();
  return all;
}

/// The symbol with which a unit of the report begins, "Pa" of "Pa for an entry"; empty where it is a phrase.
std::string symbol_in(const std::string& unit) {
  if (unit.starts_with("J per m ")) return "J/m";
  const std::string word = unit.substr(0, unit.find_first_of(" ,;("));
  return unit_symbols().contains(word) ? word : "";
}

/// "Pa", "kg_per_m3", "per_s".
std::string unit_in_names(std::string_view unit) {
  std::string name(unit);
  const auto replace = [&](std::string_view from, std::string_view to) {
    for (std::size_t at = name.find(from); at != std::string::npos; at = name.find(from))
      name.replace(at, from.size(), to);
  };
  if (name.starts_with("1/")) name.erase(0, 1);
  replace("/", "_per_");
  replace("²", "2");
  replace("³", "3");
  replace("°", "deg");
  replace(" ", "_");
  return name.starts_with('_') ? name.substr(1) : name;
}

std::string with_points(std::string_view path) {
  std::string name(path);
  std::ranges::replace(name, '/', '.');
  return name;
}

using OnNumber = std::function<void(const Result& part, const std::string& path)>;

/// Calls for every part that is a number, a vector or a matrix of numbers, or null.
/// \param positions those of lists are in the paths
void for_each_number(const Results& results, const std::string& prefix, bool positions, const OnNumber& call) {
  for (const Result& part : results.parts()) {
    if (part.key.empty()) continue;
    const std::string path = prefix + part.key;
    const auto& value = part.value.value;
    if (const auto* one = std::get_if<std::shared_ptr<const Results>>(&value)) {
      for_each_number(**one, path + "/", positions, call);
    } else if (const auto* list = std::get_if<std::shared_ptr<const std::vector<Results>>>(&value)) {
      for (std::size_t k = 0; k < (*list)->size(); ++k)
        for_each_number((**list)[k], positions ? fmt::format("{}/{}/", path, k) : path + "/", positions, call);
    } else if (!std::holds_alternative<bool>(value) && !std::holds_alternative<std::string>(value) &&
               !std::holds_alternative<std::vector<std::string>>(value)) {
      call(part, path);
    }
  }
}

/// A part that names its unit and meaning itself.
bool explains_itself(const Result& part) {
  return part.hidden && !part.label.empty();
}

/// The text of a finite single number.
std::string finite_text(const ResultValue& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value.value)) return fmt::format("{}", *whole);
  const auto* number = std::get_if<double>(&value.value);
  return number != nullptr && std::isfinite(*number) ? fmt::format("{}", *number) : "";
}

/// The quantity with the most keys from the front of a path; null: none.
const ResultQuantity* longest_match(std::string_view path) {
  static const std::unordered_map<std::string_view, const ResultQuantity*> by_path = [] {
    std::unordered_map<std::string_view, const ResultQuantity*> found;
    for (const ResultQuantity& quantity : result_quantities()) found.emplace(quantity.path, &quantity);
    return found;
  }();
  for (std::string_view front = path;;) {
    if (const auto found = by_path.find(front); found != by_path.end()) return found->second;
    const std::size_t slash = front.rfind('/');
    if (slash == std::string_view::npos) return nullptr;
    front = front.substr(0, slash);
  }
}

}  // namespace

const std::vector<ResultQuantity>& result_quantities() {
  static const std::vector<ResultQuantity> all = [] {
    std::vector<ResultQuantity> rows;
    TableCells cells;
    std::string_view rest = quantities_csv;
    for (take_record(rest); !rest.empty();) {  // the first record names the columns
      cells.split(take_record(rest), ',');
      const auto& row = cells.all();
      rows.push_back({std::string(row[0]), std::string(row[1]), std::string(row[2]), row[3] == "machine"});
    }
    return rows;
  }();
  return all;
}

std::optional<ResultQuantity> meaning_of(std::string_view path) {
  for (std::string_view rest = path;;) {
    const ResultQuantity* best = longest_match(rest);
    if (best != nullptr) {
      std::string label = best->label;
      for (const std::string_view word : parts_of(rest.substr(best->path.size()), '/'))
        if (!word.empty()) label += fmt::format(", {}", word);
      std::ranges::replace(label, '_', ' ');
      return ResultQuantity{best->path, best->unit, label, best->of_machine};
    }
    const std::size_t slash = rest.find('/');
    if (slash == std::string_view::npos) return std::nullopt;
    rest.remove_prefix(slash + 1);
  }
}

Results units_and_labels(const Results& results) {
  struct Entry {
    std::string name = {}, unit = {}, label = {};
    bool fixed = false;
  };
  std::vector<Entry> entries;
  std::map<std::string, std::size_t> places;
  for_each_number(results, "", false, [&](const Result& part, const std::string& path) {
    const auto [place, is_new] = places.try_emplace(path, entries.size());
    if (is_new) {
      const auto meaning = meaning_of(path);
      entries.push_back({.name = with_points(path)});
      if (meaning) {
        entries.back().unit = meaning->unit;
        entries.back().label = meaning->label;
      }
    }
    Entry& entry = entries[place->second];
    if (entry.fixed) return;
    if (explains_itself(part)) {
      entry.unit = part.unit, entry.label = part.label, entry.fixed = true;
    } else if (const std::string symbol = symbol_in(part.unit); !symbol.empty()) {
      entry.unit = symbol, entry.fixed = true;
    }
  });
  Results units, labels;
  for (const Entry& entry : entries) {
    if (entry.label.empty()) continue;
    units.set(entry.name, entry.unit);
    labels.set(entry.name, entry.label);
  }
  return Results().set("units", units).set("labels", labels);
}

std::vector<ScalarNumber> scalar_numbers(const Results& results) {
  std::vector<ScalarNumber> numbers;
  std::map<std::string, std::size_t> places;
  for_each_number(results, "", true, [&](const Result& part, const std::string& path) {
    const auto meaning = meaning_of(path);
    if (meaning && meaning->of_machine) return;
    const auto [place, is_new] = places.try_emplace(path, numbers.size());
    if (is_new) numbers.push_back({path, explains_itself(part) || !meaning ? "" : meaning->unit, {}});
    ScalarNumber& number = numbers[place->second];
    number.text = finite_text(part.value);  // a later value replaces an earlier one
    const std::string symbol = symbol_in(part.unit);
    if (!symbol.empty()) number.unit = symbol;
  });
  std::erase_if(numbers, [](const ScalarNumber& number) { return number.text.empty(); });
  return numbers;
}

std::string column_name(std::string_view path, std::string_view unit) {
  const std::string end = unit_in_names(unit);
  return with_points(path) + (end.empty() ? "" : "_") + end;
}

ScalarNumber number_of_column(std::string_view column) {
  ScalarNumber number;
  std::size_t longest = 0;
  for (const std::string& symbol : unit_symbols()) {
    const std::string end = fmt::format("_{}", unit_in_names(symbol));
    if (!column.ends_with(end) || end.size() <= longest) continue;
    longest = end.size();
    number.unit = symbol;
  }
  number.path = column.substr(0, column.size() - longest);
  std::ranges::replace(number.path, '.', '/');
  return number;
}

std::string describe_result() {
  std::string text = result_txt;
  for (const ResultQuantity& quantity : result_quantities())
    text += fmt::format("  {:<36} {:<6} {}\n", with_points(quantity.path), quantity.unit, quantity.label);
  return text;
}

}  // namespace equidem
