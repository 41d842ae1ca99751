// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep/sweep_curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/plots/plot.hpp"

namespace equidem {
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
    for (const double y : mean ? std::vector{sum / static_cast<double>(all.size())} : all) {
      series.x.push_back(x);
      series.y.push_back(y);
    }
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
