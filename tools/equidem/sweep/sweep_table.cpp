// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep/sweep_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/plots/plot.hpp"

namespace equidem {
namespace {

constexpr const char* number_name = "point";
constexpr const char* label_of_number = "number of the point";

const MainQuantity all_main_quantities[] = {
    {"solve", "poisson_ratio", "nu", "Poisson's ratio ν (plane strain)", "theory/poisson_ratio"},
    {"solve", "stiffness_ratio", "2G/((1-nu)kN)", "2G/((1 - ν) k_N)", "theory/stiffness_ratio"},
    {"solve", "theory/poisson_ratio", "nu theory"},
    {"solve", "theory/stiffness_ratio", "2G/((1-nu)kN) theory"},
    {"solve", "plane_strain/young_modulus", "E strain", "Young's modulus E (plane strain), Pa"},
    {"solve", "energy", "energy"},
    {"solve", "relative_residual", "residual", "", "", {Shown::power, 1}},
    {"solve", "unstable_modes", "unstable"},
    {"homogenize", "young_modulus/plane_strain", "E strain", "Young's modulus E (plane strain), Pa"},
    {"homogenize", "poisson_ratio/plane_strain", "nu strain", "Poisson's ratio ν (plane strain)"},
    {"homogenize", "bulk_modulus_2d", "K"},
    {"homogenize", "shear_modulus", "G", "shear modulus G, Pa"},
    {"homogenize", "anisotropy", "anisotropy", "", "", {Shown::number, 3}},
    {"homogenize", "ensemble/0/bulk_modulus_2d/mean", "mean K", "bulk modulus K, mean of the ensemble, Pa"},
    {"homogenize", "ensemble/0/shear_modulus/mean", "mean G", "shear modulus G, mean of the ensemble, Pa"},
    {"calibrate", "kN", "kN", "k_N, Pa"},
    {"calibrate", "kT", "kT"},
    {"calibrate", "ratio", "kT/kN", "k_T/k_N"},
    {"calibrate", "achieved/relative_error", "relative error", "", "", {Shown::power, 1}},
    {"stability", "critical_ratio", "critical kT/kN", "critical k_T/k_N"},
    {"stability", "omega_max", "omega_max"},
    {"stability", "critical_time_step", "critical step", "critical time step, s"},
    {"pack", "solid_fraction", "solid fraction", "solid fraction"},
    {"pack", "void_ratio", "void ratio", "void ratio"},
    {"pack", "coordination_number", "z", "mean number of contacts"},
    {"pack", "rattlers", "rattlers"},
    {"pack", "bonds", "bonds"},
    {"run", "waves/*/speed", "speed of *", "speed of wave *, m/s", "waves/*/theory/speed"},
    {"run", "waves/*/speed_over_theory", "over theory", "speed of wave * over that of theory"},
    {"run", "plane_strain/young_modulus", "E strain", "Young's modulus E (plane strain), Pa"},
    {"run", "plane_strain/poisson_ratio", "nu strain", "Poisson's ratio ν (plane strain)"},
    {"run", "steps", "steps"},
    {"run", "time_step", "time step"},
    {"run", "energy/kinetic", "kinetic energy", "kinetic energy"},
    {"run", "energy/dissipated", "lost energy", "energy lost"},
    {"run", "energy/relative_error", "energy error", "", "", {Shown::power, 1}},
    {"run", "measures/void_ratio/after", "void ratio", "void ratio at the end"},
    {"run", "relative_unbalanced_force", "unbalanced force", "", "", {Shown::power, 1}},
};

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

std::vector<MainQuantity> main_quantities(const SweepPlan& plan) {
  std::vector<MainQuantity> found;
  for (const MainQuantity& quantity : all_main_quantities) {
    if (quantity.verb != plan.verb) continue;
    if (quantity.path.find('*') == std::string::npos) {
      found.push_back(quantity);
      continue;
    }
    for (const std::string& wave : plan.waves) {
      MainQuantity own = quantity;
      for (std::string* text : {&own.path, &own.heading, &own.axis, &own.theory})
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
  std::vector<std::pair<MainQuantity, std::string>> shown;  // with their units
  for (const MainQuantity& quantity : main_quantities(plan)) {
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
      if (!point.failed()) row.add("", quantity.heading, point.at(quantity.path), unit, quantity.shown);
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
                                                     const MainQuantity& quantity) {
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
  const auto column = [&](const char* name) { return value.empty() ? name : fmt::format("{}_{}", name, value); };
  const auto add = [&](Series series) {
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  };
  const PlotColour colour = curve_colours[number % curve_colours.size()];
  const Marker marker = curve_markers[number % curve_markers.size()];
  const SeriesStyle alone = curve.theory.empty() ? SeriesStyle::line_with_points : SeriesStyle::points;
  if (seeds) {
    add(series_at(curve.stable, {.label = label("each seed"),
                                 .style = SeriesStyle::points,
                                 .colour = colour,
                                 .marker = marker,
                                 .filled = false,
                                 .column = column("each_seed")}));
    add(series_at(
        curve.stable,
        {.label = label("mean"), .style = alone, .colour = colour, .marker = marker, .column = column("mean")}, true));
  } else {
    add(series_at(curve.stable, {.label = which.empty() ? "computed" : which,
                                 .style = alone,
                                 .colour = colour,
                                 .marker = marker,
                                 .column = column("computed")}));
  }
  add(series_at(curve.unstable,
                {.label = label(which.empty() ? "computed, unstable or not judged" : "unstable or not judged"),
                 .style = SeriesStyle::points,
                 .colour = which.empty() ? PlotColour::vermilion : colour,
                 .marker = marker,
                 .filled = false,
                 .column = column("unstable")}));
}

std::string plot_name_of(const MainQuantity& quantity) {
  std::string name = quantity.path;
  std::ranges::replace(name, '/', '_');
  return name;
}

std::vector<MainQuantity> drawn(const SweepPlan& plan) {
  const bool curves =
      plan.keys_of_case() > 0 && plan.keys.front().numeric() && (plan.side_by_side || plan.keys_of_case() <= 2);
  std::vector<MainQuantity> quantities = curves ? main_quantities(plan) : std::vector<MainQuantity>{};
  // The energies of a wave sway: those at the end of the run say nothing.
  std::erase_if(quantities, [&](const MainQuantity& quantity) {
    return quantity.axis.empty() || (!plan.waves.empty() && quantity.path.starts_with("energy/"));
  });
  return quantities;
}

/// Whether the quantity is known at two values of the first key, since one point makes no curve, and not 0 throughout.
bool has_curve(std::span<const SweepPoint> points, const MainQuantity& quantity) {
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
std::string axis_label(std::span<const SweepPoint> points, const MainQuantity& quantity) {
  for (const SweepPoint& point : points) {
    const ScalarNumber* const number = point.find(quantity.path);
    if (number == nullptr || number->unit.empty()) continue;
    const std::string end = ", " + literal(number->unit);
    return quantity.axis.ends_with(end) ? quantity.axis : quantity.axis + end;
  }
  return quantity.axis;
}

}  // namespace

std::vector<std::string> curve_names(const SweepPlan& plan) {
  std::vector<std::string> names;
  for (const MainQuantity& quantity : drawn(plan)) names.push_back(plot_name_of(quantity));
  return names;
}

void write_curves(const std::filesystem::path& folder, const SweepPlan& plan, std::span<const SweepPoint> points,
                  const std::string& title) {
  const bool seeds = plan.has_seeds() && plan.keys.back().values.size() > 1;
  for (const MainQuantity& quantity : drawn(plan)) {
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
