// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/core/text.hpp"

#include "fujioka2005/fujioka2005.hpp"

namespace equidem::fujioka2005 {
namespace {

constexpr double gap_in_line = std::numeric_limits<double>::quiet_NaN();
constexpr double theory = restitution * restitution;

struct Look {
  PlotColour colour;
  Marker marker;
  bool filled;
};

/// One look for each law in all figures.
Look look_of(const Variant& variant) {
  static const std::map<NormalLaw, Look> look_of_law = {
      {NormalLaw::linear_dashpot, {PlotColour::orange, Marker::square, true}},
      {NormalLaw::hertz_dashpot, {PlotColour::green, Marker::triangle, true}},
      {NormalLaw::five_case_map, {PlotColour::sky_blue, Marker::diamond, false}},
      {NormalLaw::energy_map, {PlotColour::blue, Marker::circle, true}},
      {NormalLaw::exact_flow, {PlotColour::vermilion, Marker::circle, false}}};
  if (variant.label == "X stiff") return {PlotColour::black, Marker::circle, true};
  return look_of_law.at(variant.law);
}

std::string name_of(const Variant& variant) {
  return fmt::format("{} (a = {:g})", variant.label == "X stiff" ? "X" : variant.label, variant.a);
}

Series series_of(const Variant& variant, const std::string& label) {
  const Look look = look_of(variant);
  return {.label = label,
          .style = SeriesStyle::line_with_points,
          .colour = look.colour,
          .marker = look.marker,
          .filled = look.filled};
}

Plot ratio_plot(const std::string& title, const std::vector<Impacts>& impacts, double least, double most) {
  Plot plot{.title = title,
            .x = {.label = "impact", .min = 0, .max = 21},
            .y = {.label = "energy after / energy before the impact", .min = least, .max = most}};
  plot.series.push_back({.label = fmt::format("theory e² = {:.2f}", theory), .x = {0, 21}, .y = {theory, theory}});
  for (const Impacts& law : impacts) {
    Series series = series_of(law.variant, name_of(law.variant));
    for (std::size_t k = 0; k < law.ratio.size(); ++k) {
      series.x.push_back(static_cast<double>(k + 1));
      series.y.push_back(law.ratio[k]);
    }
    plot.series.push_back(series);
  }
  return plot;
}

Series mode_line(const std::string& label, double slope, double depth, double least, double most) {
  const double end = slope > 0 ? std::min(depth, most / slope) : slope < 0 ? std::min(depth, least / slope) : depth;
  return {.label = label, .x = {0, end}, .y = {0, slope * end}, .style = SeriesStyle::dashed_line};
}

/// The first impacts of some laws in the plane of depth and closing.
Plot phase_plot(const std::string& title, const std::vector<Impacts>& impacts, const std::string& laws, double depth) {
  constexpr double most = 0.5;
  Plot plot{.title = title,
            .x = {.label = "depth d, diameters", .min = 0, .max = depth},
            .y = {.label = "closing in a step p + q, diameters", .min = -most, .max = most}};
  plot.series = {mode_line("s = 1, s = 0, s = -√(1 - a)", 1, depth, -most, most), mode_line("", 0, depth, -most, most),
                 mode_line("", -std::sqrt(1 - of_springs), depth, -most, most)};
  plot.series[1].column = "s = 0";
  plot.series[2].column = "s = -root(1 - a)";
  if (laws.find('F') != std::string::npos) {
    plot.series.push_back(mode_line("s = 1/e (F)", 1 / restitution, depth, -most, most));
    plot.series.back().colour = PlotColour::sky_blue;
  }
  for (const char letter : laws) {
    const auto at = std::find_if(impacts.begin(), impacts.end(),
                                 [&](const Impacts& one) { return one.variant.label == std::string(1, letter); });
    const Impacts& law = *at;
    Series series = series_of(law.variant, name_of(law.variant));
    for (std::size_t k = 0; k < law.paths.size() && k < 8; ++k) {
      for (const auto& [d, closing] : law.paths[k]) {
        series.x.push_back(d);
        series.y.push_back(closing);
      }
      series.x.push_back(gap_in_line);
      series.y.push_back(gap_in_line);
    }
    series.filled = series.filled && letter != 'T';  // its only state lies on another
    plot.series.push_back(series);
  }
  return plot;
}

Series stacked_series(const Stacked& law, double StackedPoint::*x, double StackedPoint::*y) {
  const bool from_overlap = law.label != law.variant.label;
  Series series = series_of(law.variant, from_overlap ? law.label : name_of(law.variant));
  if (from_overlap) {
    series.filled = false;
    series.colour = PlotColour::purple;
  }
  for (const StackedPoint& point : law.points) {
    if (!(point.*x > 0) || !(point.*y > 0)) continue;
    series.x.push_back(point.*x);
    series.y.push_back(point.*y);
  }
  return series;
}

Plot stacked_plot(const Reproduction& result, const std::string& title, const std::string& label,
                  double StackedPoint::*x, double StackedPoint::*y) {
  Plot plot{.title = title,
            .x = {.label = x == &StackedPoint::step ? "time step, s" : "time of computing, s", .logarithmic = true},
            .y = {.label = label, .logarithmic = true}};
  for (const Stacked& law : result.stacked) {
    Series series = stacked_series(law, x, y);
    if (!series.x.empty()) plot.series.push_back(series);
  }
  return plot;
}

Plot ball_plot(const Reproduction& result) {
  Plot plot{.title = "A bouncing ball over 3 s: error of the height against the rigid ball",
            .x = {.label = "time of computing, s", .logarithmic = true},
            .y = {.label = "rms error of the height, of the drop", .logarithmic = true}};
  for (const BallCost& law : result.ball) {
    const bool one_step = law.label != law.variant.label;
    Series series = series_of(law.variant, one_step ? "X, step 0.1 s, a = 1e4 to 1e12" : name_of(law.variant));
    for (const BallPoint& point : law.points) {
      series.x.push_back(point.seconds);
      series.y.push_back(point.error);
    }
    plot.series.push_back(series);
  }
  return plot;
}

Plot rest_plot(const std::string& title, const std::vector<Rest>& laws) {
  constexpr double least = 1e-16;
  Plot plot{.title = title,
            .x = {.label = "time, s"},
            .y = {.label = "energy above rest, of weight times diameter", .min = least, .logarithmic = true}};
  for (const Rest& law : laws) {
    Series series = series_of(law.variant, name_of(law.variant));
    series.style = SeriesStyle::line;
    if (law.variant.law == NormalLaw::five_case_map) series.style = SeriesStyle::dashed_line;
    for (std::size_t k = 0; k < law.times.size(); ++k) {
      series.x.push_back(law.times[k]);
      series.y.push_back(std::max(least, law.energies[k]));
    }
    plot.series.push_back(series);
  }
  return plot;
}

Plot lossless_plot(const std::vector<Rest>& laws) {
  constexpr double least = 1e-9;
  Plot plot{.title = fmt::format("{} balls that lose nothing (e = 1) fall and bounce", laws.front().balls),
            .x = {.label = "time, s"},
            .y = {.label = "relative change of the energy", .min = least, .logarithmic = true}};
  for (const Rest& law : laws) {
    Series series = series_of(law.variant, name_of(law.variant));
    series.style = SeriesStyle::line;
    for (std::size_t k = 0; k < law.times.size(); ++k) {
      series.x.push_back(law.times[k]);
      series.y.push_back(std::max(least, std::abs(law.energies[k] / law.energies.front() - 1)));
    }
    plot.series.push_back(series);
  }
  return plot;
}

}  // namespace

std::vector<std::pair<std::string, Plot>> plots(const Reproduction& result) {
  std::vector<std::pair<std::string, Plot>> all;
  all.emplace_back("figure4", ratio_plot("Fujioka & Ushijima (2005), Fig. 4: slow impacts", result.slow, 0.35, 0.6));
  all.emplace_back("figure5", ratio_plot("Fujioka & Ushijima (2005), Fig. 5: fast impacts", result.fast, 0.44, 0.6));
  all.emplace_back("figure6",
                   phase_plot("Fujioka & Ushijima (2005), Fig. 6: fast impacts of C and X", result.fast, "CX", 1.3));
  all.back().second.vertical_lines = {{1, "the ball is wholly in the wall", PlotColour::black}};
  all.emplace_back(
      "figure7", phase_plot("Fujioka & Ushijima (2005), Fig. 7: fast impacts of T, F and P", result.fast, "FPT", 0.6));
  Plot fig10 = stacked_plot(result, "Fujioka & Ushijima (2005), Fig. 10: final speed d' of the stacked spheres",
                            "relative error of d'", &StackedPoint::step, &StackedPoint::speed_error);
  all.emplace_back("figure10", std::move(fig10));
  Plot fig11 = stacked_plot(result, "Fujioka & Ushijima (2005), Fig. 11: parting time T0 of the stacked spheres",
                            "relative error of T0", &StackedPoint::step, &StackedPoint::parting_error);
  const auto& steps = result.stacked.front().points;
  fig11.series.insert(fig11.series.begin(), {.label = "the paper's T0",
                                             .x = {steps.back().step, steps.front().step},
                                             .y = {printed_parting_error, printed_parting_error},
                                             .style = SeriesStyle::dashed_line});
  all.emplace_back("figure11", std::move(fig11));
  all.emplace_back("stacked_cost",
                   stacked_plot(result, "Stacked spheres: error of d' against the time of computing",
                                "relative error of d'", &StackedPoint::seconds, &StackedPoint::speed_error));
  all.emplace_back("ball_cost", ball_plot(result));
  all.emplace_back("rest", rest_plot("One ball falls and comes to rest", result.rest));
  all.emplace_back("column",
                   rest_plot(fmt::format("{} balls fall and settle", result.column.front().balls), result.column));
  all.emplace_back("lossless", lossless_plot(result.lossless));
  return all;
}

}  // namespace equidem::fujioka2005
