// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/fields/spectrum.hpp"
#include "equidem/output/files/csv.hpp"

#include "sukegawa2010/sukegawa2010.hpp"
#include "tables.hpp"

namespace equidem::sukegawa2010 {
namespace {

/// Each seed before (open) and after (filled): between the walls, away from them, and as printed.
Plot void_ratio_plot(const Reproduction& result) {
  Plot plot{.title = "Void ratio before (open) and after (filled) 400 gal, 10 Hz",
            .x = {.label = "1 discs   2 ellipses   3 bonded pairs   4 rigid pairs", .min = 0.5, .max = 4.5},
            .y = {.label = "void ratio"}};
  struct Kept {
    const char* label;
    PlotColour colour;
    Marker marker;
    double offset;
  };
  const auto add = [&](const Kept& kept, bool after, const auto& values_of) {
    Series series{.label = std::string(kept.label) + (after ? ", after" : ", before"),
                  .style = SeriesStyle::points,
                  .colour = kept.colour,
                  .marker = kept.marker,
                  .filled = after};
    for (std::size_t k = 0; k < printed_void_ratios.size(); ++k) {
      for (const double e : values_of(printed_void_ratios[k])) {
        series.x.push_back(static_cast<double>(k + 1) + kept.offset + (after ? 0.06 : -0.06));
        series.y.push_back(e);
      }
    }
    plot.series.push_back(series);
  };
  const auto computed = [&](double Outcome::*value) {
    return [&result, value](const Printed& printed) { return values_of(result, {.shape = printed.shape}, value); };
  };
  const auto printed = [](double Printed::*value) {
    return [value](const Printed& one) {
      return one.*value == 0 ? std::vector<double>{} : std::vector<double>{one.*value};
    };
  };
  const Kept whole{"between the walls, each seed", PlotColour::blue, Marker::circle, -0.24};
  const Kept inner{"away from walls and surface", PlotColour::green, Marker::triangle, 0.24};
  const Kept thesis{"printed", PlotColour::vermilion, Marker::square, 0};
  add(whole, false, computed(&Outcome::whole_before));
  add(whole, true, computed(&Outcome::whole));
  add(thesis, false, printed(&Printed::before));
  add(thesis, true, printed(&Printed::after));
  add(inner, false, computed(&Outcome::void_ratio_before));
  add(inner, true, computed(&Outcome::void_ratio));
  return plot;
}

/// A number against the frequency, one curve per amplitude.
Plot over_frequency(const Reproduction& result, Shape shape, const std::string& title, const std::string& label,
                    double Outcome::*value) {
  constexpr std::array colours{PlotColour::blue, PlotColour::vermilion, PlotColour::green};
  constexpr std::array markers{Marker::circle, Marker::square, Marker::triangle};
  Plot plot{.title = title,
            .x = {.label = "frequency, Hz", .min = 0.8, .max = 12, .logarithmic = true},
            .y = {.label = label}};
  for (std::size_t k = 0; k < 3; ++k) {
    const double acceleration = 400 * static_cast<double>(k + 1);
    std::vector<Done> runs = mapped(result, shape);
    std::erase_if(runs, [&](const Done& done) {
      const double f = done.run.shaking->frequency;
      return done.run.shaking->gal != acceleration || (f != 1 && f != 2 && f != 5 && f != 10);
    });
    std::sort(runs.begin(), runs.end(),
              [](const Done& a, const Done& b) { return a.run.shaking->frequency < b.run.shaking->frequency; });
    if (runs.empty()) continue;
    plot.series.push_back(with_points(
        {.label = fmt::format("{:g} gal", acceleration),
         .style = SeriesStyle::line_with_points,
         .colour = colours[k],
         .marker = markers[k]},
        runs, [](const Done& d) { return d.run.shaking->frequency; }, [&](const Done& d) { return d.outcome.*value; }));
  }
  return plot;
}

Plot resonance_plot(const Reproduction& result) {
  const std::vector<Done> runs = resonance_runs(result);
  Plot plot{.title = "Discs shaken by 400 gal: swing of their centre of mass over that of a liquid tilted by a/g",
            .x = {.label = "period of shaking, s", .min = 0.0, .max = 2.6},
            .y = {.label = "amplification", .min = 0, .max = 4}};
  if (runs.empty()) return plot;
  const Done& last = runs.back();
  const double width = last.run.fill.grid.width(), depth = last.outcome.height_before;
  Series liquid{.label = "liquid, linear theory", .style = SeriesStyle::dashed_line};
  for (int k = 4; k <= 260; ++k) {
    liquid.x.push_back(0.01 * k);
    liquid.y.push_back(std::min(50.0, liquid_amplification(liquid.x.back(), width, depth)));
  }
  plot.series = {liquid, with_points(
                             {.label = "discs", .style = SeriesStyle::points, .colour = PlotColour::blue}, runs,
                             [](const Done& d) { return 1 / d.run.shaking->frequency; }, amplification_of)};
  plot.vertical_lines = {{first_period(last), fmt::format("T1, depth {:.2f} m", depth), PlotColour::black},
                         {printed_period, "printed 1.85 s", PlotColour::vermilion}};
  return plot;
}

/// Columns of a CSV file of a run, by name; none where there is no file.
struct Columns {
  std::vector<std::vector<std::string>> cells;

  explicit Columns(const std::filesystem::path& path) {
    if (std::filesystem::exists(path)) cells = csv_cells(read_file(path));
  }
  [[nodiscard]] std::vector<double> of(const std::string& name) const {
    std::vector<double> values;
    if (cells.empty()) return values;
    const auto& head = cells.front();
    const auto column = static_cast<std::size_t>(std::find(head.begin(), head.end(), name) - head.begin());
    for (std::size_t r = 1; r < cells.size() && column < head.size(); ++r)
      values.push_back(csv_number(cells[r][column]).value_or(NAN));
    return values;
  }
};

/// Curves of the nine grains, less their first values. Empty where the table lacks them.
/// \param x, y "time", "x", "y" or "angle"
/// \param scale of positions
Plot curves_of(const Columns& columns, const StartGrid& grid, const std::string& x, const std::string& y,
               double scale) {
  constexpr std::array colours{PlotColour::blue,     PlotColour::vermilion, PlotColour::green,
                               PlotColour::black,    PlotColour::orange,    PlotColour::purple,
                               PlotColour::sky_blue, PlotColour::yellow,    PlotColour::black};
  Plot plot;
  for (std::size_t k = 0; k < colours.size(); ++k) {
    const auto less_first = [&](const std::string& name) {
      if (name == "time") return columns.of("time_s");
      auto values = columns.of(fmt::format("{}{}_{}", name, k, name == "angle" ? "rad" : "m"));
      const double first = values.empty() ? 0 : values.front(), factor = name == "angle" ? 1 : scale;
      for (double& value : values) value = factor * (value - first);
      return values;
    };
    Series series{.label = label_of_followed(grid, k),
                  .x = less_first(x),
                  .y = less_first(y),
                  .style = k < 8 ? SeriesStyle::line : SeriesStyle::dashed_line,
                  .colour = colours[k]};
    if (series.x.empty() || series.y.empty()) return {};
    plot.series.push_back(std::move(series));
  }
  return plot;
}

/// Paths and histories of the nine grains, for the first filling of each shape and its shaking by 400 gal, 10 Hz.
void add_histories(const Reproduction& result, const std::filesystem::path& folder, Named<Plot>& plots) {
  for (const Done& done : result.runs) {
    const Run& run = done.run;
    if (!run.shown || !run.fill.variant.empty() || run.shaking->gal != 400 || run.shaking->frequency != 10) continue;
    const std::string shape = plural_of(run.fill.shape);
    const auto add = [&](bool shaken, const std::string& name, const std::string& title, const char* x, const char* y,
                         const std::string& x_label, const std::string& y_label) {
      const Columns columns(folder / "runs" / ((shaken ? run.name() : run.fill.name()) + ".csv"));
      Plot plot = curves_of(columns, run.fill.grid, x, y, shaken ? 1e3 : 1);
      plot.title = title;
      plot.x.label = x_label;
      plot.y.label = y_label;
      plots.emplace_back(fmt::format("{}_{}", shape, name), std::move(plot));
    };
    for (const bool shaken : {false, true}) {
      const std::string title = fmt::format("{}, {}", words(shape), shaken ? "400 gal, 10 Hz" : "falling");
      const std::string stage = shaken ? "shaken_" : "falling_", unit = shaken ? "mm" : "m";
      add(shaken, stage + "x", title, "time", "x", "time, s",
          fmt::format("displacement along x{}, {}", shaken ? " in the box" : "", unit));
      add(shaken, stage + "y", title, "time", "y", "time, s", "displacement along y, " + unit);
      add(shaken, stage + "angle", title, "time", "angle", "time, s", "rotation, rad");
    }
    add(true, "paths", fmt::format("Paths, {}, 400 gal, 10 Hz", words(shape)), "x", "y",
        "displacement along x in the box, mm", "displacement along y, mm");
  }
}

/// Discs shaken by 400 gal, 10 Hz for 20 s, with both limits of friction.
Plot compaction_over_time(const Reproduction& result, const std::filesystem::path& folder) {
  Plot plot{.title = "Discs shaken by 400 gal, 10 Hz for 20 s",
            .x = {.label = "time of shaking, s"},
            .y = {.label = "void ratio between the walls"}};
  for (const Done& done : result.runs) {
    const Run& run = done.run;
    const bool printed_cap = run.fill.variant == "printed_cap";
    if (run.fill.shape != Shape::disc || run.fill.seed != 1 || run.shaking->cycles != long_shakings[1] ||
        !(run.fill.variant.empty() || printed_cap))
      continue;
    const Columns columns(folder / "runs" / (run.name() + ".csv"));
    plot.series.push_back(
        {.label = printed_cap ? "friction caps the spring alone (2.16)" : "friction caps spring and dashpot",
         .x = columns.of("time_s"),
         .y = columns.of("whole_void_ratio"),
         .colour = printed_cap ? PlotColour::vermilion : PlotColour::blue});
  }
  if (plot.series.empty() || plot.series.front().x.empty()) return {};
  const double end = plot.series.front().x.back();
  for (const auto& [e, label] :
       {std::pair{printed_void_ratios[0].before, "printed, before"}, {printed_void_ratios[0].after, "printed, after"}})
    plot.series.push_back({.label = label, .x = {0, end}, .y = {e, e}, .style = SeriesStyle::dashed_line});
  return plot;
}

bool has_points(const Plot& plot) {
  return std::any_of(plot.series.begin(), plot.series.end(), [](const Series& series) {
    return std::any_of(series.y.begin(), series.y.end(), [](double y) { return std::isfinite(y); });
  });
}

}  // namespace

Named<Plot> plots(const Reproduction& result, const Folder& folder) {
  Named<Plot> all;
  all.emplace_back("void_ratio", void_ratio_plot(result));
  for (const Shape shape : {Shape::disc, Shape::bonded_pair}) {
    const std::string name = plural_of(shape);
    const auto add = [&](const char* what, const char* title, const char* label, double Outcome::*value) {
      all.emplace_back(fmt::format("{}_{}", what, name),
                       over_frequency(result, shape, fmt::format("{}: {}", words(name), title), label, value));
    };
    add("compaction", "void ratio after shaking one filling", "void ratio", &Outcome::void_ratio);
    add("roughness", "roughness of the surface after shaking", "standard deviation, m", &Outcome::roughness);
    add("thrown", "grains thrown while shaken", "grains", &Outcome::thrown);
  }
  all.emplace_back("resonance", resonance_plot(result));
  if (folder) {
    all.emplace_back("compaction_over_time", compaction_over_time(result, *folder));
    add_histories(result, *folder, all);
  }
  std::erase_if(all, [](const auto& named) { return !has_points(named.second); });
  return all;
}

}  // namespace equidem::sukegawa2010
