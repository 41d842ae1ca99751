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

namespace equidem {
namespace {

/// A value before and after: "LABEL 0.2 before, 0.18 after".
void add_both(Results& out, const std::string& key, const std::string& label, double before, double after,
              const std::string& unit = {}) {
  const std::string space = unit.empty() ? "" : unit + " ";
  out.add(key + "/before", label, before, space + "before", {.digits = 4})
      .add(key + "/after", "", after, space + "after", {.digits = 4});
}

}  // namespace

Results GrainMeasures::results() const {
  const MeasuredMoment& before = measures_.before();
  const MeasuredMoment& after = measures_.moments().back();
  Results out;
  out.set("mean_diameter", measures_.mean_diameter());
  const bool shakes = resolved_.shaking || std::ranges::any_of(resolved_.stages, [](const StageCase& stage) {
                        return stage.shaking.has_value();
                      });
  if (shakes) {
    out.line("measured", "before, at ")
        .add("time/before", "t =", before.time, "s", {.digits = 4})
        .note(", and after, at ")
        .add("time/after", "", after.time, "s", {.digits = 4});
  } else {
    out.set("time/before", before.time).set("time/after", after.time);
  }
  out.line("void ratio");
  add_both(out, "void_ratio", "e =", before.void_ratio, after.void_ratio);
  out.note("; ");
  add_both(out, "porosity", "porosity", before.porosity, after.porosity);
  out.note(resolved_.measures->region ? "; in the region given" : "; away from walls and surface");
  out.line("surface");
  add_both(out, "surface_height", "height", before.surface.height, after.surface.height, "m");
  out.note("; ");
  add_both(out, "surface_slope", "slope", before.surface.slope, after.surface.slope);
  out.note("; ");
  add_both(out, "surface_roughness", "roughness", before.surface.roughness, after.surface.roughness, "m");
  out.line("settlement")
      .add("settlement", "of the surface", before.surface.height - after.surface.height, "m", {.digits = 4})
      .add("settlement_of_centre", "of the centre of mass", before.centre.y - after.centre.y, "m", {.digits = 4});
  out.line("outside").add("outside", "", after.outside, "grain", {Shown::count}).note(" outside the box at the end");
  if (resolved_.measures->region && std::isnan(after.void_ratio))
    out.line("WARNING", resolved_.where("measures.region") +
                            ": no body is left in the region at the end, and there is no void ratio; end the run "
                            "earlier, or give another region");
  if (std::isnan(after.surface.height))
    out.line("WARNING", resolved_.where("measures") +
                            ": no heap of bodies is left in the box at the end, and there is no surface; end the run "
                            "earlier, or close the box by walls");
  if (const auto [grid, why] = grid_of_fields(); !why.empty()) out.line("WARNING", why);
  return out.under("measures");
}

/// The grid at the end; empty, with the reason, where there is nothing to measure.
std::pair<CoarseGrid, std::string> GrainMeasures::grid_of_fields() const {
  if (!resolved_.measures->cell) return {};
  try {
    return {measures_.grid_of_fields(simulation_.present()), ""};
  } catch (const Error& error) {
    return {CoarseGrid{.region = {}, .columns = 0, .rows = 0},
            fmt::format("{}: there are no fields at the end: {}", resolved_.where("measures.cell"), error.what())};
  }
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
  write_fields(folder, "fields", measures_.fields(simulation_.present(), grid_of_fields().first), overwrite);
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
  for (const Probe& probe : resolved.probes) {
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
