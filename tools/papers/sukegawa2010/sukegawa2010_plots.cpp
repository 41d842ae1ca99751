// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/fields/spectrum.hpp"

#include "csv_cells.hpp"
#include "sukegawa2010/sukegawa2010.hpp"

namespace equidem::sukegawa2010 {
namespace {

constexpr std::array colours{PlotColour::blue,     PlotColour::vermilion, PlotColour::green,
                             PlotColour::black,    PlotColour::orange,    PlotColour::purple,
                             PlotColour::sky_blue, PlotColour::yellow,    PlotColour::black};
constexpr std::array markers{Marker::circle, Marker::square, Marker::triangle};

Plot void_ratio_plot(const Reproduction& result) {
  Series before{
      .label = "computed before, each seed", .style = SeriesStyle::points, .colour = PlotColour::blue, .filled = false};
  Series after{.label = "computed after", .style = SeriesStyle::points, .colour = PlotColour::blue};
  Series printed_before{.label = "printed before",
                        .style = SeriesStyle::points,
                        .colour = PlotColour::vermilion,
                        .marker = Marker::square,
                        .filled = false};
  Series printed_after{.label = "printed after",
                       .style = SeriesStyle::points,
                       .colour = PlotColour::vermilion,
                       .marker = Marker::square};
  double place = 0;
  for (const Printed& printed : printed_void_ratios) {
    ++place;
    const Kind kind{.shape = printed.shape};
    for (const double e : sample_of(result, kind, [](const Outcome& o) { return o.void_ratio_before; }).values) {
      before.x.push_back(place - 0.1);
      before.y.push_back(e);
    }
    for (const double e : sample_of(result, kind, [](const Outcome& o) { return o.void_ratio; }).values) {
      after.x.push_back(place + 0.1);
      after.y.push_back(e);
    }
    if (printed.before == 0) continue;
    printed_before.x.push_back(place - 0.2);
    printed_before.y.push_back(printed.before);
    printed_after.x.push_back(place + 0.2);
    printed_after.y.push_back(printed.after);
  }
  Plot plot{.title = "Void ratio before and after 400 gal, 10 Hz",
            .x = {.label = "1 discs   2 ellipses   3 bonded pairs   4 rigid pairs", .min = 0.5, .max = 4.5},
            .y = {.label = "void ratio"}};
  plot.series = {before, after, printed_before, printed_after};
  return plot;
}

/// A number against the frequency, a curve for each amplitude.
Plot over_frequency(const Reproduction& result, Shape shape, const std::string& title, const std::string& label,
                    const std::function<double(const Outcome&)>& value) {
  Plot plot{.title = title,
            .x = {.label = "frequency, Hz", .min = 0.8, .max = 12, .logarithmic = true},
            .y = {.label = label}};
  for (std::size_t k = 0; k < 3; ++k) {
    const double acceleration = 400 * static_cast<double>(k + 1);
    Series series{.label = fmt::format("{:g} gal", acceleration),
                  .style = SeriesStyle::line_with_points,
                  .colour = colours[k],
                  .marker = markers[k]};
    for (const double frequency : {1, 2, 5, 10}) {
      for (const Done& done : result.runs) {
        const Run& run = done.run;
        if (!run.mapped || run.fill.shape != shape || run.shaking->gal != acceleration ||
            run.shaking->frequency != frequency)
          continue;
        series.x.push_back(frequency);
        series.y.push_back(value(done.outcome));
      }
    }
    if (!series.x.empty()) plot.series.push_back(series);
  }
  return plot;
}

Plot resonance_plot(const Reproduction& result) {
  Plot plot{.title = "Discs shaken by 400 gal: swing of their centre of mass over that of a liquid tilted by a/g",
            .x = {.label = "period of shaking, s", .min = 0.0, .max = 2.6},
            .y = {.label = "amplification", .min = 0, .max = 4}};
  Series grains{.label = "discs", .style = SeriesStyle::points, .colour = PlotColour::blue};
  Series liquid{.label = "liquid, linear theory", .style = SeriesStyle::dashed_line};
  const Done* any = nullptr;
  for (const Done& done : result.runs) {
    if (!done.run.mapped || done.run.fill.shape != Shape::disc || done.run.shaking->gal != 400) continue;
    any = &done;
    grains.x.push_back(1 / done.run.shaking->frequency);
    grains.y.push_back(amplification_of(done));
  }
  if (any == nullptr) return plot;
  const double width = any->run.fill.grid.width(), depth = any->outcome.height_before;
  for (int k = 4; k <= 260; ++k) {
    liquid.x.push_back(0.01 * k);
    liquid.y.push_back(std::min(50.0, liquid_amplification(liquid.x.back(), width, depth)));
  }
  plot.mark_points_outside = false;
  plot.series = {liquid, grains};
  plot.vertical_lines = {{first_period(*any), fmt::format("T1, depth {:.2f} m", depth), PlotColour::black},
                         {printed_period, "printed 1.85 s", PlotColour::vermilion}};
  return plot;
}

struct Columns {
  std::vector<std::vector<std::string>> cells;
  [[nodiscard]] std::vector<double> of(const std::string& name) const {
    const auto& head = cells.front();
    const auto column = static_cast<std::size_t>(std::find(head.begin(), head.end(), name) - head.begin());
    std::vector<double> values;
    for (std::size_t r = 1; r < cells.size() && column < head.size(); ++r)
      values.push_back(csv_number(cells[r][column]).value_or(NAN));
    return values;
  }
};

/// Curves of the grains that are followed, less what they were at first. None where the table lacks them.
/// \param x, y "time", "x", "y" or "angle"
/// \param scale of the places
Plot curves_of(const Columns& columns, const StartGrid& grid, const std::string& x, const std::string& y,
               double scale) {
  Plot plot;
  for (std::size_t k = 0; k < 9; ++k) {
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

/// Paths and histories of the grains followed, of the first filling of each shape and its shaking by 400 gal, 10 Hz.
void add_histories(const Reproduction& result, const std::filesystem::path& folder,
                   std::vector<std::pair<std::string, Plot>>& plots) {
  for (const Done& done : result.runs) {
    const Run& run = done.run;
    if (!run.shown || !run.fill.variant.empty() || run.shaking->gal != 400 || run.shaking->frequency != 10) continue;
    for (const bool shaken : {false, true}) {
      const auto path = folder / "runs" / ((shaken ? run.name() : run.fill.name()) + ".csv");
      if (!std::filesystem::exists(path)) continue;
      const Columns columns{csv_cells(read_file(path))};
      const std::string shape = plural_of(run.fill.shape), stage = shaken ? "shaken" : "falling";
      for (const auto& [y, label] :
           {std::pair{"x", shaken ? "displacement along x in the box, mm" : "displacement along x, m"},
            {"y", shaken ? "displacement along y, mm" : "displacement along y, m"},
            {"angle", "rotation, rad"}}) {
        Plot plot = curves_of(columns, run.fill.grid, "time", y, shaken ? 1e3 : 1);
        if (plot.series.empty()) continue;
        plot.title = fmt::format("{}, {}", words(shape), shaken ? "400 gal, 10 Hz" : "falling");
        plot.x.label = "time, s";
        plot.y.label = label;
        plots.emplace_back(fmt::format("{}_{}_{}", shape, stage, y), std::move(plot));
      }
      if (!shaken) continue;
      Plot plot = curves_of(columns, run.fill.grid, "x", "y", 1e3);
      if (plot.series.empty()) continue;
      plot.title = fmt::format("Paths, {}, 400 gal, 10 Hz", words(shape));
      plot.x.label = "displacement along x in the box, mm";
      plot.y.label = "displacement along y, mm";
      plots.emplace_back(fmt::format("{}_paths", shape), std::move(plot));
    }
  }
}

/// Discs shaken by 400 gal, 10 Hz for long, under either cap of friction.
Plot compaction_over_time(const Reproduction& result, const std::filesystem::path& folder) {
  Plot plot{.title = "Discs shaken by 400 gal, 10 Hz for 20 s",
            .x = {.label = "time of shaking, s"},
            .y = {.label = "void ratio between the walls"}};
  for (const Done& done : result.runs) {
    const Run& run = done.run;
    const auto path = folder / "runs" / (run.name() + ".csv");
    const bool printed_cap = run.fill.variant == "printed_cap";
    if (run.fill.shape != Shape::disc || run.fill.seed != 1 || run.shaking->cycles != long_shakings[1] ||
        !(run.fill.variant.empty() || printed_cap) || !std::filesystem::exists(path))
      continue;
    const Columns columns{csv_cells(read_file(path))};
    plot.series.push_back(
        {.label = printed_cap ? "friction caps the spring alone (2.16)" : "friction caps spring and dashpot",
         .x = columns.of("time_s"),
         .y = columns.of("whole_void_ratio"),
         .style = SeriesStyle::line,
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

std::vector<std::pair<std::string, Table>> tables(const Reproduction& result) {
  Table table;
  std::vector<std::string> names, shapes, variants;
  std::vector<std::int64_t> seeds, cycles;
  std::vector<double> accelerations, frequencies;
  for (const Done& done : result.runs) {
    names.push_back(done.run.name());
    shapes.push_back(plural_of(done.run.fill.shape));
    variants.push_back(done.run.fill.variant);
    seeds.push_back(static_cast<std::int64_t>(done.run.fill.seed));
    accelerations.push_back(done.run.shaking->gal);
    frequencies.push_back(done.run.shaking->frequency);
    cycles.push_back(done.run.shaking->cycles);
  }
  table.add("run", names).add("shape", shapes).add("variant", variants).add("seed", seeds);
  table.add("acceleration_gal", accelerations).add("frequency_Hz", frequencies).add("cycles", cycles);
  for (const OutcomeKey& key : outcome_keys()) {
    std::vector<double> values;
    for (const Done& done : result.runs) values.push_back(done.outcome.*key.value);
    table.add(key.name, values);
  }
  return {{"runs", table}};
}

std::vector<std::pair<std::string, Plot>> plots(const Reproduction& result,
                                                const std::optional<std::filesystem::path>& folder) {
  std::vector<std::pair<std::string, Plot>> all;
  all.emplace_back("void_ratio", void_ratio_plot(result));
  for (const Shape shape : {Shape::disc, Shape::bonded_pair}) {
    const std::string name = plural_of(shape);
    const auto add = [&](const char* what, const char* title, const char* label, auto value) {
      all.emplace_back(fmt::format("{}_{}", what, name),
                       over_frequency(result, shape, fmt::format("{}: {}", words(name), title), label, value));
    };
    add("compaction", "void ratio after shaking one filling", "void ratio",
        [](const Outcome& o) { return o.void_ratio; });
    add("roughness", "roughness of the surface after shaking", "standard deviation, m",
        [](const Outcome& o) { return o.roughness; });
    add("thrown", "grains thrown while shaken", "grains", [](const Outcome& o) { return o.thrown; });
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
