// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep/sweep_plan.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::size_t most_points = 1000000;

/// Before the memory for them is taken.
void check_points(double points) {
  constexpr double bytes_a_point = 1000, fastest = 1e-3;  // of the table in memory; s
  if (points <= static_cast<double>(most_points)) return;
  bad_input(fmt::format("the sweep has {:.3g} points", points),
            fmt::format("the table alone would take {}, and at a millisecond for each they take {:.2g} hours",
                        readable_bytes(points * bytes_a_point), points * fastest / 3600),
            fmt::format("Give at most {} points: fewer values, or --list", grouped(std::int64_t{most_points})));
}

/// A whole number without a point, so that integer keys take it.
std::string number_text(double value) {
  constexpr double exact = 1e15;
  return value == std::floor(value) && std::abs(value) < exact ? fmt::format("{:.0f}", value + 0.0)
                                                               : toml_number(value);
}

/// A number as it is written in tables, or a word of the case file, "cholmod", "true", "none", "../a.json".
std::string value_from(std::string_view part, const std::string& list) {
  if (const auto whole = number_from<std::int64_t>(part)) return fmt::format("{}", *whole);
  if (const std::optional<double> number = number_from<double>(part)) {
    if (std::isfinite(*number)) return number_text(*number);
  } else if (!part.empty()) {
    const char first = part.front();
    const bool begins_as_word = std::isalpha(static_cast<unsigned char>(first)) != 0 || first == '.' || first == '/';
    const bool one_word = std::ranges::none_of(part, [](char c) {
      const auto byte = static_cast<unsigned char>(c);
      return byte <= ' ' || byte == 0x7f || std::string_view("=[]{}\"'").find(c) != std::string_view::npos;
    });
    if (begins_as_word && one_word) return std::string(part);
  }
  bad_input_at(
      "--values",
      part.empty() ? fmt::format("a value is missing in '{}'", list) : fmt::format("'{}' is among the values", part),
      "a sweep takes finite numbers, words, true and false", "Leave it out, or correct it");
}

std::vector<std::string> values_of_range(double from, double to, int steps) {
  std::vector<std::string> values;
  const int intervals = steps - 1;
  for (int k = 0; k < steps; ++k) {
    const double value = intervals == 0 ? from : (from * (intervals - k) + to * k) / intervals;
    // The decimal number that is meant, 0.3 and not 0.30000000000000004; and a spring that is absent, not one
    // that is almost absent.
    const double rounding = 1e-13 * std::max(std::abs(from), std::abs(to));
    const double meant = std::abs(value) <= rounding ? 0 : *number_from<double>(fmt::format("{:.12g}", value));
    if (!std::isfinite(meant))
      bad_input("the values from --from to --to overflow", "a sweep needs finite numbers", "Give smaller ones");
    values.push_back(number_text(meant));
  }
  return values;
}

SweptKey swept_key(const KeyOptions& given) {
  if (given.name.empty()) bad_input("values are given without a key", "they would vary nothing", "Add --key KEY");
  if (given.name == SweepPlan::seed)
    bad_input("'seed' is not a key of a case", "assemblies and packings have seeds of their own", "Use --seeds");
  const bool range = given.from && given.to;
  if (range == !given.values.empty() || given.from.has_value() != given.to.has_value()) {
    bad_input(given.values.empty() ? fmt::format("the key {} is given no values", given.name)
                                   : fmt::format("the key {} is given a list of values and a range", given.name),
              given.values.empty() ? "nothing would vary" : "a key takes one of the two",
              "Give --values a,b,c or --from A --to B --steps N");
  }
  SweptKey key{.name = given.name, .unit = unit_of_case_key(given.name).value_or(""), .values = {}};
  if (range) key.values = values_of_range(*given.from, *given.to, given.steps);
  for (const std::string& list : given.values)
    for (const std::string_view part : parts_of(list, ',')) key.values.push_back(value_from(part, list));
  if (given.name == "ratio" && !key.numeric()) {
    const auto word = std::ranges::find_if(key.values, [](const auto& value) { return !number_from<double>(value); });
    bad_input_at("--values", fmt::format("'{}' is among the values of ratio", *word), "it is kT/kN, a number",
                 "Leave it out, or correct it");
  }
  return key;
}

SweptKey swept_seeds(const std::vector<std::string>& lists) {
  SweptKey key{.name = SweepPlan::seed, .unit = {}, .values = {}};
  for (const std::string& list : lists) {
    for (const std::string_view part : parts_of(list, ',')) {
      const std::size_t dash = part.find('-');
      const auto first = number_from<std::int64_t>(part.substr(0, dash));
      const auto last = dash == std::string_view::npos ? first : number_from<std::int64_t>(part.substr(dash + 1));
      if (!first || !last || *first < 0 || *last < *first)
        bad_input_at("--seeds", fmt::format("'{}' is among the seeds", part),
                     fmt::format("a seed is a whole number from 0 to {}, a range two of them",
                                 std::numeric_limits<std::int64_t>::max()),
                     "Write --seeds 1,2,3 or --seeds 1-3");
      const auto count = static_cast<std::size_t>(*last - *first) + 1;
      check_points(static_cast<double>(key.values.size()) + static_cast<double>(count));
      for (std::size_t k = 0; k < count; ++k)
        key.values.push_back(fmt::format("{}", *first + static_cast<std::int64_t>(k)));
    }
  }
  return key;
}

void check_lists(const SweepPlan& plan) {
  const SweptKey& first = plan.keys.front();
  for (const SweptKey& key : plan.keys) {
    if (!plan.side_by_side || key.name == SweepPlan::seed || key.values.size() == first.values.size()) continue;
    bad_input(fmt::format("{} takes {} and {} takes {}", first.name, counted(std::ssize(first.values), "value"),
                          key.name, key.values.size()),
              "with --list they stand side by side",
              "Give as many to each key, or leave out --list for all combinations");
  }
}

/// [springs] with kT at the given ratio to kN, whatever file they were read from.
std::string springs_of_ratio(const TomlValue& base, const std::string& ratio) {
  const TomlValue& springs = *base.find("springs");
  const double kT = *number_from<double>(ratio) * springs.find("kN")->real;
  std::string entries;
  for (const TomlEntry& entry : springs.entries) {
    const TomlValue& value = entry.value;
    entries += fmt::format("{}{} = {}", entries.empty() ? "" : ", ", entry.name,
                           entry.name == "kT"  ? toml_number(kT)
                           : value.is_number() ? toml_number(value.real)
                                               : toml_text(value.text));
  }
  return fmt::format("springs={{{}}}", entries);
}

}  // namespace

bool SweptKey::numeric() const {
  return std::ranges::all_of(values, [](const std::string& value) { return number_from<double>(value).has_value(); });
}

ResultValue SweptKey::shown(const std::string& value) {
  if (const auto whole = number_from<std::int64_t>(value)) return *whole;
  if (const auto number = number_from<double>(value)) return *number;
  return value;
}

double SweepPlan::points() const {
  double points = 1;
  for (const SweptKey& key : keys)
    if (!side_by_side || &key == keys.data() || key.name == seed) points *= static_cast<double>(key.values.size());
  return points;
}

std::vector<std::string> SweepPlan::values_of(std::size_t point) const {
  std::vector<std::string> values(keys.size());
  for (std::size_t k = keys.size(); k-- > 0;) {
    const std::size_t count = keys[k].values.size();
    values[k] = keys[k].values[point % count];
    if (!side_by_side || keys[k].name == seed) point /= count;
  }
  return values;
}

std::string SweepPlan::names() const {
  return joined(keys, &SweptKey::name);
}

SweepPlan sweep_plan(const std::string& verb, const std::vector<KeyOptions>& keys,
                     const std::vector<std::string>& seeds, bool side_by_side) {
  SweepPlan plan{.verb = verb, .keys = {}, .side_by_side = side_by_side};
  std::ranges::transform(keys, std::back_inserter(plan.keys), swept_key);
  if (!seeds.empty()) plan.keys.push_back(swept_seeds(seeds));
  if (plan.keys.empty())
    bad_input("the sweep varies nothing", "neither --key nor --seeds is given",
              "Give --key K --values a,b,c, or --seeds 1-5");
  std::set<std::string> names;
  for (const SweptKey& key : plan.keys)
    if (!names.insert(key.name).second)
      bad_input(fmt::format("the key {} is given twice", key.name), "one point has one value of it",
                "Put all its values into one --values");
  check_lists(plan);
  check_points(plan.points());
  return plan;
}

std::vector<std::string> options_of(const SweepPlan& plan, const std::vector<std::string>& values,
                                    const TomlValue& base) {
  std::vector<std::string> options;
  for (std::size_t k = 0; k < plan.keys.size(); ++k) {
    const std::string &name = plan.keys[k].name, &value = values[k];
    const bool bare = number_from<double>(value) || value == "true" || value == "false" || value == "none";
    if (name == SweepPlan::seed) {
      options.insert(options.end(), {"--seed", value});
    } else if (name == "ratio") {
      options.insert(options.end(), {"--set", springs_of_ratio(base, value)});
    } else {
      options.insert(options.end(), {"--set", fmt::format("{}={}", name, bare ? value : toml_text(value))});
    }
  }
  return options;
}

}  // namespace equidem
