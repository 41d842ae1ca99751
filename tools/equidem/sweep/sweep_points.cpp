// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep/sweep_points.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/output/plots/plot.hpp"

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

/// A value as it stands in a file.
std::string toml_of(const std::string& value) {
  const bool bare = number_from<double>(value) || value == "true" || value == "false" || value == "none";
  return bare ? value : toml_text(value);
}

std::string toml_of(const TomlValue& value) {
  if (value.is_number()) return toml_number(value.real);
  return value.type == TomlValue::Type::boolean ? (value.boolean ? "true" : "false") : toml_text(value.text);
}

constexpr std::string_view prefix_of_springs = "springs.";

/// [springs] of a point, whatever file they were read from: with the values of its keys, and kT by the ratio to kN.
std::string springs_of_ratio(const SweepPlan& plan, const std::vector<std::string>& values, const TomlValue& base) {
  std::map<std::string, std::string> entries;
  for (const TomlEntry& entry : base.find("springs")->entries) entries[entry.name] = toml_of(entry.value);
  double ratio = 0;
  for (std::size_t k = 0; k < plan.keys.size(); ++k) {
    const std::string& name = plan.keys[k].name;
    if (name == "ratio") ratio = *number_from<double>(values[k]);
    if (name.starts_with(prefix_of_springs)) entries[name.substr(prefix_of_springs.size())] = toml_of(values[k]);
  }
  if (const auto kN = number_from<double>(entries["kN"])) entries["kT"] = toml_number(ratio * *kN);
  return fmt::format("springs={{{}}}", joined(entries, [](const auto& entry) {
                       return fmt::format("{} = {}", entry.first, entry.second);
                     }));
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
  const bool by_ratio = std::ranges::find(plan.keys, "ratio", &SweptKey::name) != plan.keys.end();
  if (by_ratio) options = {"--set", springs_of_ratio(plan, values, base)};
  for (std::size_t k = 0; k < plan.keys.size(); ++k) {
    const std::string& name = plan.keys[k].name;
    if (name == "ratio" || (by_ratio && name.starts_with(prefix_of_springs))) continue;
    if (name == SweepPlan::seed) {
      options.insert(options.end(), {"--seed", values[k]});
    } else {
      options.insert(options.end(), {"--set", fmt::format("{}={}", name, toml_of(values[k]))});
    }
  }
  return options;
}

namespace {

constexpr const char* number_name = "point";
constexpr const char* label_of_number = "number of the point";

std::string key_column(const SweptKey& key) {
  return column_name(key.name, key.unit.substr(0, key.unit.find_first_of(" ,;(")));
}

/// Names of all numbers: those of a point follow one another in its order.
std::vector<std::string> columns_of_numbers(std::span<const SweepPoint> points) {
  std::vector<std::string> names;
  for (const SweepPoint& point : points) {
    auto place = names.begin();
    for (const ScalarNumber& number : point.numbers) {
      const std::string name = column_name(number.path, number.unit);
      const auto found = std::ranges::find(names, name);
      place = std::next(found != names.end() ? found : names.insert(place, name));
    }
  }
  return names;
}

}  // namespace

const ScalarNumber* SweepPoint::find(std::string_view path) const {
  const auto found = std::ranges::find(numbers, path, &ScalarNumber::path);
  return found == numbers.end() ? nullptr : &*found;
}

double SweepPoint::at(std::string_view path) const {
  const ScalarNumber* const found = find(path);
  return found == nullptr ? unknown : number_from<double>(found->text).value_or(unknown);
}

std::vector<ShownNumber> main_quantities(const SweepPlan& plan) {
  std::vector<ShownNumber> found;
  for (const ShownNumber& quantity : numbers_shown_of(plan.verb, "sweep")) {
    if (quantity.path.find('*') == std::string::npos) {
      found.push_back(quantity);
      continue;
    }
    for (const std::string& wave : plan.waves) {
      ShownNumber own = quantity;
      for (std::string* text : {&own.path, &own.label, &own.axis, &own.theory})
        if (const std::size_t at = text->find('*'); at != std::string::npos)
          text->replace(at, 1, text == &own.axis ? literal(wave) : wave);
      found.push_back(std::move(own));
    }
  }
  return found;
}

Table sweep_table(const SweepPlan& plan, std::span<const SweepPoint> points) {
  Table table;
  table.add(number_name, points, &SweepPoint::number);
  std::vector<std::string> names_of_keys;
  for (std::size_t k = 0; k < plan.keys.size(); ++k) {
    names_of_keys.push_back(key_column(plan.keys[k]));
    table.add(names_of_keys.back(), points, [k](const SweepPoint& point) { return point.values[k]; });
  }
  table.add("status", points, &SweepPoint::status);
  std::map<std::string, std::vector<std::string>> cells;
  const std::vector<std::string> names = columns_of_numbers(points);
  for (const std::string& name : names) cells[name].resize(points.size());
  for (std::size_t row = 0; row < points.size(); ++row)
    for (const ScalarNumber& number : points[row].numbers)
      cells[column_name(number.path, number.unit)][row] = number.text;
  for (const std::string& name : names)  // what a verb repeats of the point, such as the ratio, stands there already
    if (std::ranges::find(names_of_keys, name) == names_of_keys.end()) table.add(name, std::move(cells[name]));
  return table.add("message", points, &SweepPoint::message);
}

std::vector<SweepPoint> read_sweep_points(const std::filesystem::path& path, const SweepPlan& plan) {
  const StoredTable table(path, {}, "sweep",
                          "Remove the row, and it is computed again; or choose another --out, or leave out --resume");
  const std::vector<std::string>& columns = table.columns();
  const std::size_t status = plan.keys.size() + 1, message = columns.size() - 2;
  const std::vector<Table::Column> own = sweep_table(plan, {}).columns();
  const auto is_own = [&](std::size_t column) { return columns[column] == own[column].name; };
  bool all = columns.size() >= own.size() + 1 && columns[message] == own.back().name;
  for (std::size_t column = 0; all && column <= status; ++column) all = is_own(column);
  if (!all) table.refuse("its columns are those of another sweep, or of another table");
  std::vector<SweepPoint> points(table.rows());
  for (std::size_t row = 0; row < points.size(); ++row) {
    SweepPoint& point = points[row];
    point.number = table.integer(row, 0, 1);
    for (std::size_t k = 0; k < plan.keys.size(); ++k) point.values.push_back(table.text(row, k + 1));
    point.status = table.text(row, status);
    for (std::size_t column = status + 1; column < message; ++column) {
      if (table.text(row, column).empty()) continue;
      static_cast<void>(table.number(row, column));
      point.numbers.push_back(number_of_column(columns[column]));
      point.numbers.back().text = table.text(row, column);
    }
    point.message = table.text(row, message);
  }
  return points;
}

std::vector<Results> sweep_rows(const SweepPlan& plan, std::span<const SweepPoint> points) {
  std::vector<std::pair<ShownNumber, std::string>> shown;  // with their units
  for (const ShownNumber& quantity : main_quantities(plan)) {
    const auto known = std::ranges::find_if(points, [&](const SweepPoint& point) { return point.find(quantity.path); });
    if (known != points.end()) shown.emplace_back(quantity, known->find(quantity.path)->unit);
  }
  std::vector<Results> rows;
  for (const SweepPoint& point : points) {
    Results row;
    row.set(number_name, point.number, "", label_of_number);
    for (std::size_t k = 0; k < plan.keys.size(); ++k) {
      const SweptKey& key = plan.keys[k];
      row.add("", key.name, SweptKey::shown(point.values[k]), key.unit, {.digits = 8});
      row.set(key.name, SweptKey::shown(point.values[k]), key.unit, "key " + key.name);
      if (k == 0) row.set("value", SweptKey::shown(point.values[k]), key.unit, "key " + key.name);
    }
    row.add("status", "status", point.status);
    for (const auto& [quantity, unit] : shown)
      if (!point.failed()) row.add("", quantity.label, point.at(quantity.path), unit, quantity.shown);
    for (const ScalarNumber& number : point.numbers) {
      const auto meaning = meaning_of(number.path);
      row.set(number.path, SweptKey::shown(number.text), number.unit, meaning ? meaning->label : "");
    }
    if (!point.message.empty()) row.set("message", point.message);
    rows.push_back(std::move(row));
  }
  return rows;
}

namespace {

constexpr std::array curve_colours{PlotColour::blue,     PlotColour::vermilion, PlotColour::green, PlotColour::orange,
                                   PlotColour::sky_blue, PlotColour::purple,    PlotColour::black};
constexpr std::array curve_markers{Marker::circle, Marker::square, Marker::triangle, Marker::diamond};

std::string name_of_key(const SweptKey& key) {
  return key.name == "ratio" ? "k_T/k_N" : literal(key.name);
}

std::string axis_label(const SweptKey& key) {
  return key.unit.empty() ? name_of_key(key) : fmt::format("{}, {}", name_of_key(key), key.unit);
}

/// Values of one quantity by the first key, of one value of the second.
struct Curve {
  std::map<double, std::vector<double>> theory, stable, unstable;
};

/// Curves by the value of the second key, in the order of its values; "" where there is none.
std::vector<std::pair<std::string, Curve>> curves_of(const SweepPlan& plan, std::span<const SweepPoint> points,
                                                     const ShownNumber& quantity) {
  const bool several = !plan.side_by_side && plan.keys_of_case() == 2;
  std::vector<std::pair<std::string, Curve>> curves;
  for (const std::string& value : several ? plan.keys[1].values : std::vector<std::string>{""})
    if (std::ranges::find(curves, value, &std::pair<std::string, Curve>::first) == curves.end())
      curves.emplace_back(value, Curve{});
  for (const SweepPoint& point : points) {
    const auto own = std::ranges::find(curves, several ? point.values[1] : "", &std::pair<std::string, Curve>::first);
    const auto x = number_from<double>(point.values[0]);
    if (own == curves.end() || !x) continue;
    if (const double theory = point.at(quantity.theory); !std::isnan(theory)) own->second.theory[*x] = {theory};
    const double y = point.at(quantity.path);
    const bool stable = point.status != "unstable" && point.status != "unjudged" && point.status != "mechanism";
    if (!std::isnan(y)) (stable ? own->second.stable : own->second.unstable)[*x].push_back(y);
  }
  return curves;
}

Series series_at(const std::map<double, std::vector<double>>& values, Series series, bool mean = false) {
  for (const auto& [x, all] : values) {
    const double sum = std::accumulate(all.begin(), all.end(), 0.0);
    for (const double y : mean ? std::vector{sum / static_cast<double>(all.size())} : all) series.add(x, y);
  }
  return series;
}

/// The line of theory; without label and column of its own where there is one for all curves.
void add_theory(Plot& plot, const Curve& curve, const std::string& which, const std::string& value, PlotColour colour) {
  if (curve.theory.empty()) return;
  plot.series.push_back(
      series_at(curve.theory, {.label = which.empty() ? "theory" : fmt::format("{}, theory", which),
                               .colour = colour,
                               .column = value.empty() ? "theory" : fmt::format("theory_{}", value)}));
}

/// The computed points of one curve. \param which "springs.kT = 0", empty for the only one
void add_points(Plot& plot, const Curve& curve, const std::string& which, const std::string& value, std::size_t number,
                bool seeds) {
  const auto label = [&](const std::string& what) { return which.empty() ? what : fmt::format("{}, {}", which, what); };
  const PlotColour colour = curve_colours[number % curve_colours.size()];
  const SeriesStyle alone = curve.theory.empty() ? SeriesStyle::line_with_points : SeriesStyle::points;
  const auto add = [&](const auto& values, Series series, bool mean = false) {
    series.marker = curve_markers[number % curve_markers.size()];
    if (!value.empty()) series.column += "_" + value;
    if (!values.empty()) plot.series.push_back(series_at(values, std::move(series), mean));
  };
  const auto add_open = [&](const auto& values, const std::string& name, PlotColour own, const char* column) {
    add(values, {.label = label(name), .style = SeriesStyle::points, .colour = own, .filled = false, .column = column});
  };
  if (seeds) {
    add_open(curve.stable, "each seed", colour, "each_seed");
    add(curve.stable, {.label = label("mean"), .style = alone, .colour = colour, .column = "mean"}, true);
  } else {
    add(curve.stable,
        {.label = which.empty() ? "computed" : which, .style = alone, .colour = colour, .column = "computed"});
  }
  which.empty() ? add_open(curve.unstable, "computed, unstable or not judged", PlotColour::vermilion, "unstable")
                : add_open(curve.unstable, "unstable or not judged", colour, "unstable");
}

std::string plot_name_of(const ShownNumber& quantity) {
  std::string name = quantity.path;
  std::ranges::replace(name, '/', '_');
  return name;
}

std::vector<ShownNumber> drawn(const SweepPlan& plan) {
  const bool curves =
      plan.keys_of_case() > 0 && plan.keys.front().numeric() && (plan.side_by_side || plan.keys_of_case() <= 2);
  std::vector<ShownNumber> quantities = curves ? main_quantities(plan) : std::vector<ShownNumber>{};
  // The energies of a wave sway: those at the end of the run say nothing.
  std::erase_if(quantities, [&](const ShownNumber& quantity) {
    return quantity.axis.empty() || (!plan.waves.empty() && quantity.path.starts_with("energy/"));
  });
  return quantities;
}

/// Whether the quantity is known at two values of the first key, since one point makes no curve, and not 0 throughout.
bool has_curve(std::span<const SweepPoint> points, const ShownNumber& quantity) {
  std::set<std::string> values;
  bool any = false;
  for (const SweepPoint& point : points) {
    if (point.find(quantity.path) == nullptr) continue;
    values.insert(point.values[0]);
    any = any || point.at(quantity.path) != 0;
  }
  return any && values.size() > 1;
}

/// The axis with the unit of the results, where it does not name one.
std::string axis_label(std::span<const SweepPoint> points, const ShownNumber& quantity) {
  for (const SweepPoint& point : points) {
    const ScalarNumber* const number = point.find(quantity.path);
    if (number == nullptr || number->unit.empty()) continue;
    const std::string end = ", " + literal(number->unit);
    return quantity.axis.ends_with(end) ? quantity.axis : quantity.axis + end;
  }
  return quantity.axis;
}

}  // namespace

std::vector<std::string> files_of_curves(const SweepPlan& plan) {
  std::vector<std::string> names;
  for (const ShownNumber& quantity : drawn(plan))
    std::ranges::move(plot_files(plot_name_of(quantity)), std::back_inserter(names));
  return names;
}

void write_curves(const std::filesystem::path& folder, const SweepPlan& plan, std::span<const SweepPoint> points,
                  const std::string& title) {
  const bool seeds = plan.has_seeds() && plan.keys.back().values.size() > 1;
  for (const ShownNumber& quantity : drawn(plan)) {
    if (!has_curve(points, quantity)) continue;
    Plot plot{.title = title.empty() ? joined(plan.keys, name_of_key) + " varied" : literal(title),
              .x = {.label = axis_label(plan.keys.front())},
              .y = {.label = axis_label(points, quantity)},
              .enhanced = true};
    const auto curves = curves_of(plan, points, quantity);
    const bool one_theory = std::ranges::all_of(
        curves, [&](const auto& curve) { return curve.second.theory == curves.front().second.theory; });
    if (one_theory) add_theory(plot, curves.front().second, "", "", PlotColour::black);
    for (std::size_t k = 0; k < curves.size(); ++k) {
      const auto& [value, curve] = curves[k];
      const std::string which = value.empty() ? "" : literal(fmt::format("{} = {}", plan.keys[1].name, value));
      if (!one_theory) add_theory(plot, curve, which, value, curve_colours[k % curve_colours.size()]);
      add_points(plot, curve, which, value, k, seeds);
    }
    write_plot(folder, plot_name_of(quantity), plot, true);
  }
}

}  // namespace equidem
