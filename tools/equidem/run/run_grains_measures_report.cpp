// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/pictures/field_files.hpp"
#include "equidem/output/plots/plot.hpp"

#include "run/run_grains_measures.hpp"
#include "solve/report.hpp"

namespace equidem {
namespace {

std::string shown(double value, const char* unit = "") {
  return std::isnan(value) ? "unknown" : fmt::format("{:.4g}{}", value, unit);
}

void set_known(JsonObject& object, const std::string& key, double value) {
  if (std::isnan(value)) {
    object.set(key, nullptr);
  } else {
    object.set(key, value);
  }
}

JsonObject before_and_after(double before, double after) {
  JsonObject object;
  set_known(object, "before", before);
  set_known(object, "after", after);
  return object;
}

}  // namespace

std::string GrainMeasures::describe() const {
  const MeasuredMoment& before = measures_.before();
  const MeasuredMoment& after = measures_.moments().back();
  std::string out;
  if (resolved_.shaking)
    out += report_line("measured",
                       fmt::format("before, at t = {:.4g} s, and after, at {:.4g} s", before.time, after.time));
  out += report_line("void ratio",
                     fmt::format("e = {} before, {} after (porosity {}, {}), {}", shown(before.void_ratio),
                                 shown(after.void_ratio), shown(before.porosity), shown(after.porosity),
                                 resolved_.measures->region ? "in the region given" : "away from walls and surface"));
  out +=
      report_line("surface", fmt::format("height {} before, {} after; slope {}, {}; roughness {}, {}",
                                         shown(before.surface.height, " m"), shown(after.surface.height, " m"),
                                         shown(before.surface.slope), shown(after.surface.slope),
                                         shown(before.surface.roughness, " m"), shown(after.surface.roughness, " m")));
  out += report_line("settlement", fmt::format("of the surface {}, of the centre of mass {}",
                                               shown(before.surface.height - after.surface.height, " m"),
                                               shown(before.centre.y - after.centre.y, " m")));
  out += report_line(
      "thrown",
      fmt::format("{} were further than {} from the heap at a moment looked at, {} at the end; {} outside the box",
                  counted(static_cast<long long>(after.ever_thrown), "grain"),
                  shown(resolved_.measures->thrown_gap * measures_.mean_diameter(), " m"), after.thrown,
                  after.outside));
  const Sloshing slosh = measures_.sloshing();
  const std::string theory =
      std::isnan(slosh.theory) ? "" : fmt::format("; linear theory of a liquid {:.4g} s", slosh.theory);
  out += report_line(
      "sloshing",
      slosh.missing.empty()
          ? fmt::format(
                "strongest period of the slope {:.4g} s from t = {:.4g} s on, amplitude {:.2g}, periods from {:.3g} to "
                "{:.3g} s are one{}",
                slosh.period, slosh.from, slosh.amplitude, 1 / (1 / slosh.period + slosh.frequency_resolution),
                1 / std::max(1e-300, 1 / slosh.period - slosh.frequency_resolution), theory)
          : fmt::format("no period: {}{}", slosh.missing, theory));
  return out;
}

void GrainMeasures::add_to(JsonObject& object) const {
  const MeasuredMoment& before = measures_.before();
  const MeasuredMoment& after = measures_.moments().back();
  const Sloshing slosh = measures_.sloshing();
  JsonObject period;
  set_known(period, "period", slosh.period);
  set_known(period, "theory_period", slosh.theory);
  period.set("from", slosh.from)
      .set("amplitude", slosh.amplitude)
      .set("frequency_resolution", slosh.frequency_resolution);
  JsonObject measures;
  measures.set("mean_diameter", measures_.mean_diameter())
      .set("time", before_and_after(before.time, after.time))
      .set("void_ratio", before_and_after(before.void_ratio, after.void_ratio))
      .set("porosity", before_and_after(before.porosity, after.porosity))
      .set("surface_height", before_and_after(before.surface.height, after.surface.height))
      .set("surface_slope", before_and_after(before.surface.slope, after.surface.slope))
      .set("surface_roughness", before_and_after(before.surface.roughness, after.surface.roughness));
  set_known(measures, "settlement", before.surface.height - after.surface.height);
  measures.set("settlement_of_centre", before.centre.y - after.centre.y)
      .set("thrown", after.ever_thrown)
      .set("thrown_at_the_end", after.thrown)
      .set("outside", after.outside)
      .set("sloshing", period);
  object.set("measures", measures);
}

void GrainMeasures::write_files(const std::filesystem::path& folder, bool overwrite) const {
  if (resolved_.output.picture) {
    Plot plot{.title = resolved_.title};
    plot.x.label = "x, m";
    plot.y.label = "surface, m";
    const auto add = [&](const SurfaceProfile& profile, double time, PlotColour colour) {
      Series series{
          .label = fmt::format("t = {:.4g} s", time), .style = SeriesStyle::line_with_points, .colour = colour};
      for (std::size_t k = 0; k < profile.heights.size(); ++k) {
        series.x.push_back(profile.place(k));
        series.y.push_back(profile.heights[k]);
      }
      plot.series.push_back(std::move(series));
    };
    add(measures_.surface_before(), measures_.before().time, PlotColour::sky_blue);
    add(measures_.surface(), measures_.moments().back().time, PlotColour::vermilion);
    write_plot(folder, "surface_plot", plot, overwrite);
    Series ratio{.label = "", .colour = PlotColour::blue, .column = "void_ratio"};
    for (const MeasuredMoment& moment : measures_.moments()) {
      ratio.x.push_back(moment.time);
      ratio.y.push_back(moment.void_ratio);
    }
    if (std::any_of(ratio.y.begin(), ratio.y.end(), [](double e) { return std::isfinite(e); })) {
      Plot history{.title = resolved_.title};
      history.x.label = "time, s";
      history.y.label = "void ratio e";
      history.series.push_back(std::move(ratio));
      write_plot(folder, "void_ratio_plot", history, overwrite);
    }
  }
  if (!resolved_.measures->cell) return;
  write_fields(folder, "fields", measures_.fields(simulation_), overwrite);
}

std::string describe_shaking(const GrainCase& resolved) {
  if (!resolved.shaking) return {};
  const Shaking& shaking = *resolved.shaking;
  const GroundMotion& motion = shaking.motion;
  const std::string size =
      fmt::format("{:.4g} m/s² ({:.4g} gal) at most", motion.peak_acceleration, motion.peak_acceleration / gal);
  const std::string along = fmt::format("along ({:.4g}, {:.4g})", shaking.direction.x, shaking.direction.y);
  std::string out = report_line(
      "shaking", shaking.recorded
                     ? fmt::format("{} {}, a record of {} points from {:.4g} s to {:.4g} s", size, along,
                                   motion.displacement.times.size(), motion.displacement.times.front(),
                                   motion.displacement.times.back())
                     : fmt::format("{} {}, {} Hz, {} from {:.4g} s to {:.4g} s", size, along, shaking.frequency,
                                   counted(static_cast<long long>(shaking.cycles), "cycle"), motion.displacement.start,
                                   motion.displacement.end));
  out +=
      report_line("", fmt::format("at most {:.4g} m/s and {:.4g} m", motion.peak_velocity, motion.peak_displacement));
  if (shaking.recorded && motion.correction > 0)
    out += report_line("", fmt::format("baseline: up to {:.3g} of that acceleration taken away",
                                       motion.correction / motion.peak_acceleration));
  if (motion.final_displacement != 0 && std::abs(motion.final_displacement) > 1e-9 * motion.peak_displacement)
    out += report_line("", fmt::format("the box ends {:.4g} m from where it began", motion.final_displacement));
  return out;
}

void add_shaking(JsonObject& object, const GrainCase& resolved) {
  if (!resolved.shaking) return;
  const GroundMotion& motion = resolved.shaking->motion;
  JsonObject shaking;
  shaking.set("direction", std::vector{resolved.shaking->direction.x, resolved.shaking->direction.y})
      .set("peak_acceleration", motion.peak_acceleration)
      .set("peak_velocity", motion.peak_velocity)
      .set("peak_displacement", motion.peak_displacement)
      .set("final_displacement", motion.final_displacement)
      .set("baseline_correction", motion.correction);
  object.set("shaking", shaking);
}

void write_probe_paths(const std::filesystem::path& folder, const GrainCase& resolved, bool overwrite) {
  constexpr PlotColour colours[] = {PlotColour::blue,     PlotColour::vermilion, PlotColour::green,  PlotColour::orange,
                                    PlotColour::sky_blue, PlotColour::purple,    PlotColour::yellow, PlotColour::black};
  if (!resolved.output.probe_interval) return;
  const auto cells = csv_cells(read_file(folder / "history.csv"));
  Plot plot{.title = resolved.title};
  plot.x.label = "x, m";
  plot.y.label = "y, m";
  const auto& names = cells.front();
  for (const GrainProbe& probe : resolved.probes) {
    const auto at = std::find(names.begin(), names.end(), probe.name + "_x_m");
    if (at == names.end() || plot.series.size() == std::size(colours)) continue;
    const auto column = static_cast<std::size_t>(at - names.begin());
    Series series{.label = probe.name, .colour = colours[plot.series.size()]};
    for (std::size_t k = 1; k < cells.size(); ++k) {
      series.x.push_back(csv_number(cells[k].at(column)).value_or(not_measured));
      series.y.push_back(csv_number(cells[k].at(column + 1)).value_or(not_measured));
    }
    plot.series.push_back(std::move(series));
  }
  if (!plot.series.empty()) write_plot(folder, "paths_plot", plot, overwrite);
}

}  // namespace equidem
