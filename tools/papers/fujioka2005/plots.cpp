// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/core/text.hpp"

#include "fujioka2005/fujioka2005.hpp"
#include "tables.hpp"

namespace equidem::fujioka2005 {
namespace {

std::string name_of(const Variant& variant) {
  return fmt::format("{} (a = {:g})", letter_of(variant.law), variant.a);
}

/// Each variant has one colour and marker in all figures.
Series series_of(const Variant& variant, const std::string& label) {
  struct Look {
    const char* label;
    PlotColour colour;
    Marker marker;
    bool filled;
  };
  constexpr std::array looks{Look{"C", PlotColour::orange, Marker::square, true},
                             Look{"T", PlotColour::green, Marker::triangle, true},
                             Look{"T soft", PlotColour::purple, Marker::triangle, false},
                             Look{"F", PlotColour::sky_blue, Marker::diamond, false},
                             Look{"P", PlotColour::blue, Marker::circle, true},
                             Look{"X", PlotColour::vermilion, Marker::circle, false},
                             Look{"X stiff", PlotColour::black, Marker::circle, true}};
  const Look& look =
      *std::find_if(looks.begin(), looks.end(), [&](const Look& one) { return variant.label == one.label; });
  return {.label = label,
          .style = SeriesStyle::line_with_points,
          .colour = look.colour,
          .marker = look.marker,
          .filled = look.filled};
}

/// F after P, with which it often coincides: its open marker or dashed line leaves P in sight.
void draw_F_over_P(Plot& plot) {
  const auto of = [&](PlotColour colour) {
    return std::find_if(plot.series.begin(), plot.series.end(), [&](const Series& s) { return s.colour == colour; });
  };
  const auto f = of(PlotColour::sky_blue), p = of(PlotColour::blue);
  if (f != plot.series.end() && p != plot.series.end() && f < p) std::iter_swap(f, p);
}

Plot ratio_plot(const std::string& title, const std::vector<Impacts>& impacts, double least, double most,
                std::vector<double> Impacts::*ratio = &Impacts::ratio) {
  Plot plot{.title = title,
            .x = {.label = "impact", .min = 0, .max = 21},
            .y = {.label = "energy after / energy before the impact", .min = least, .max = most}};
  plot.series.push_back({.label = fmt::format("theory e² = {:.2f}", theory), .x = {0, 21}, .y = {theory, theory}});
  for (const Impacts& law : impacts) {
    Series series = series_of(law.variant, name_of(law.variant));
    series.y = law.*ratio;
    if (law.variant.label == "X stiff") series.style = SeriesStyle::dashed_line;  // its markers would hide those of P
    for (std::size_t k = 0; k < series.y.size(); ++k) series.x.push_back(static_cast<double>(k + 1));
    plot.series.push_back(series);
  }
  return plot;
}

/// The first impacts of some laws in the plane of depth and closing.
/// \param laws labels
Plot phase_plot(const std::string& title, const std::vector<Impacts>& impacts, const std::vector<std::string>& laws,
                double depth) {
  constexpr double most = 0.5;
  Plot plot{.title = title,
            .x = {.label = "depth d, diameters", .min = 0, .max = depth},
            .y = {.label = "closing in a step p + q, diameters", .min = -most, .max = most}};
  const auto add_line = [&](const char* label, const char* column, double slope) {
    const double end = slope == 0 ? depth : std::min(depth, most / std::abs(slope));
    plot.series.push_back(
        {.label = label, .x = {0, end}, .y = {0, slope * end}, .style = SeriesStyle::dashed_line, .column = column});
  };
  add_line("s = 1, s = 0, s = -√(1 - a)", "", 1);
  add_line("", "s = 0", 0);
  add_line("", "s = -root(1 - a)", -std::sqrt(1 - stiffness_of(NormalLaw::energy_map)));
  if (std::find(laws.begin(), laws.end(), "F") != laws.end()) {
    add_line("s = 1/e (F)", "", 1 / restitution);
    plot.series.back().colour = PlotColour::sky_blue;
  }
  for (const std::string& label : laws) {
    const Impacts& law =
        *std::find_if(impacts.begin(), impacts.end(), [&](const Impacts& one) { return one.variant.label == label; });
    Series series = series_of(law.variant, name_of(law.variant));
    for (std::size_t k = 0; k < law.paths.size() && k < 8; ++k) {
      for (const auto& [d, closing] : law.paths[k]) {
        series.x.push_back(d);
        series.y.push_back(closing);
      }
      constexpr double gap_in_line = std::numeric_limits<double>::quiet_NaN();
      series.x.push_back(gap_in_line);
      series.y.push_back(gap_in_line);
    }
    series.filled = series.filled && label != "T";  // the only state of T coincides with another
    plot.series.push_back(series);
  }
  return plot;
}

/// Curves in the plane of two members; points where one is zero are left out.
Plot curve_plot(const std::string& title, const std::string& label, const std::vector<Curve>& curves,
                double CurvePoint::*x, double CurvePoint::*y) {
  Plot plot{.title = title,
            .x = {.label = x == &CurvePoint::step ? "time step, s" : "time of computing, s", .logarithmic = true},
            .y = {.label = label, .logarithmic = true}};
  for (const Curve& curve : curves) {
    const bool special = curve.label != curve.variant.label;
    std::vector<CurvePoint> points = curve.points;
    std::erase_if(points, [&](const CurvePoint& point) { return !(point.*x > 0) || !(point.*y > 0); });
    if (points.empty()) continue;
    Series series = series_of(curve.variant, special ? curve.label : name_of(curve.variant));
    if (special && curve.variant.label == "C") {
      series.filled = false;
      series.colour = PlotColour::purple;
    }
    plot.series.push_back(with_points(series, points, x, y));
  }
  draw_F_over_P(plot);
  return plot;
}

/// A quantity of columns against time, not below `least`.
template <class Value>
Plot time_plot(const std::string& title, const std::string& label, double least, const std::vector<Rest>& laws,
               Value value) {
  Plot plot{.title = title, .x = {.label = "time, s"}, .y = {.label = label, .min = least, .logarithmic = true}};
  for (const Rest& law : laws) {
    Series series = series_of(law.variant, name_of(law.variant));
    series.style = SeriesStyle::line;
    series.x = law.times;
    for (std::size_t k = 0; k < law.times.size(); ++k) series.y.push_back(std::max(least, value(law, k)));
    plot.series.push_back(series);
  }
  return plot;
}

Plot rest_plot(const std::string& title, const std::vector<Rest>& laws) {
  Plot plot = time_plot(title, "energy above rest, of weight times diameter", 1e-16, laws,
                        [](const Rest& law, std::size_t k) { return law.energies[k]; });
  plot.series[2].style = SeriesStyle::dashed_line;  // F
  draw_F_over_P(plot);
  return plot;
}

}  // namespace

Named<Plot> plots(const Reproduction& r) {
  using P = CurvePoint;
  const std::string paper = "Fujioka & Ushijima (2005), Fig. ";
  const std::string speed_error = "relative error of d'";
  Plot fig6 = phase_plot(paper + "6: fast impacts of C and X; in the wall for d > 1", r.fast, {"C", "X"}, 1.3);
  fig6.vertical_lines = {{1, "", PlotColour::black}};
  Plot fig11 = curve_plot(paper + "11: parting time T0 of the stacked spheres", "relative error of T0", r.stacked,
                          &P::step, &P::parting_error);
  const auto& steps = r.stacked.front().points;
  fig11.series.insert(fig11.series.begin(), {.label = "the paper's T0",
                                             .x = {steps.back().step, steps.front().step},
                                             .y = {printed_parting_error, printed_parting_error},
                                             .style = SeriesStyle::dashed_line});
  Plot ball = curve_plot("A bouncing ball over 3 s: error of the height against the rigid ball",
                         "rms error of the height, of the drop", r.ball, &P::seconds, &P::error);
  ball.series.back().label = "X, step 0.1 s, a = 1e4 to 1e12";
  const int balls = r.column.front().balls, lossless = r.lossless.front().balls;
  return {{"figure4", ratio_plot(paper + "4: slow impacts, steps of contact and parting", r.slow, 0.35, 0.6)},
          {"figure4_flights",
           ratio_plot(paper + "4: slow impacts, from flight to flight", r.slow, 0.35, 0.6, &Impacts::flight_ratio)},
          {"figure5", ratio_plot(paper + "5: fast impacts; F, P and X lie on the line of theory", r.fast, 0.4, 0.7)},
          {"figure6", fig6},
          {"figure7", phase_plot(paper + "7: fast impacts of T, F and P", r.fast, {"F", "P", "T soft", "T"}, 0.6)},
          {"figure10", curve_plot(paper + "10: final speed d' of the stacked spheres", speed_error, r.stacked, &P::step,
                                  &P::speed_error)},
          {"figure11", fig11},
          {"stacked_cost", curve_plot("Stacked spheres: error of d' against the time of computing", speed_error,
                                      r.stacked, &P::seconds, &P::speed_error)},
          {"ball_cost", ball},
          {"rest", rest_plot("One ball falls and comes to rest", r.rest)},
          {"column", rest_plot(fmt::format("{} balls fall and settle", balls), r.column)},
          {"lossless", time_plot(fmt::format("{} balls that lose nothing (e = 1) fall and bounce", lossless),
                                 "relative change of the energy", 1e-9, r.lossless,
                                 [](const Rest& law, std::size_t k) { return std::abs(law.change(k)); })}};
}

}  // namespace equidem::fujioka2005
