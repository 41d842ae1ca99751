// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains_measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/pictures/field_files.hpp"
#include "equidem/output/plots/plot.hpp"

namespace equidem {
namespace {

const std::vector<std::string>& columns_of_moments() {
  static const std::vector<std::string> columns{
      "step",       "time_s",     "void_ratio", "porosity", "surface_height_m", "surface_slope", "surface_roughness_m",
      "centre_x_m", "centre_y_m", "outside"};
  return columns;
}

std::vector<double> cells_of(const MeasuredMoment& m) {
  return {m.time,           m.void_ratio,    m.porosity,
          m.surface.height, m.surface.slope, m.surface.roughness,
          m.centre.x,       m.centre.y,      static_cast<double>(m.outside)};
}

constexpr const char *table_name = "measures.csv", *profiles_name = "surface.csv";

/// Rows of numbers of a table that a checkpoint counts on.
std::vector<std::vector<double>> rows_of(const std::filesystem::path& folder, const FileMark& mark) {
  const auto cells = csv_cells(read_marked(folder / mark.name, mark));
  std::vector<std::vector<double>> rows;
  for (std::size_t k = 1; k < cells.size(); ++k) {
    rows.emplace_back();
    for (const std::string& cell : cells[k]) rows.back().push_back(csv_number(cell).value_or(not_measured));
  }
  return rows;
}

/// The shakings of a case, with the times of those that have begun.
std::vector<BoxShaking> shakings_of(const GrainCase& resolved, const StagedSimulation* simulation) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  if (resolved.shaking) return {{.shaking = *resolved.shaking}};
  std::vector<BoxShaking> shakings;
  for (std::size_t k = 0; k < resolved.stages.size(); ++k) {
    if (!resolved.stages[k].shaking) continue;
    BoxShaking& shaking = shakings.emplace_back(BoxShaking{.shaking = *resolved.stages[k].shaking, .from = unknown});
    if (simulation == nullptr || k >= simulation->reports().size()) continue;
    const StageReport& report = simulation->reports()[k];
    const double step = simulation->time_step();
    shaking.from = static_cast<double>(report.first) * step;
    if (report.over) shaking.until = static_cast<double>(report.last) * step;
  }
  return shakings;
}

BoxMeasures measures_of(const GrainCase& resolved) {
  return casefile::with_place(resolved.where(resolved.measures->cell ? "measures.cell" : "measures"), [&] {
    return BoxMeasures(resolved.scene, *resolved.measures, shakings_of(resolved, nullptr));
  });
}

}  // namespace

GrainMeasures::GrainMeasures(const GrainCase& resolved, const StagedSimulation& simulation)
    : resolved_(resolved), simulation_(simulation), measures_(measures_of(resolved)) {}

void GrainMeasures::open(const std::filesystem::path& folder, bool overwrite, const Checkpoint* from) {
  folder_ = folder;
  GrowingCsvOptions options{.overwrite = overwrite};
  if (from != nullptr) options.continue_from = from->mark_of(table_name);
  table_.emplace(folder / table_name, columns_of_moments(), options);
  std::vector<std::string> names{"step", "time_s"};
  const SurfaceProfile profile = measures_.empty_profile();
  for (std::size_t k = 0; k < measures_.columns(); ++k) names.push_back(fmt::format("x_{:.6g}_m", profile.place(k)));
  if (from != nullptr) options.continue_from = from->mark_of(profiles_name);
  profiles_.emplace(folder / profiles_name, names, options);
  if (from != nullptr) go_on(*from);
}

void GrainMeasures::go_on(const Checkpoint& from) {
  std::vector<MeasuredMoment> moments;
  for (const auto& row : rows_of(folder_, from.mark_of(table_name))) {
    moments.push_back({.step = static_cast<std::int64_t>(row[0]),
                       .time = row[1],
                       .void_ratio = row[2],
                       .porosity = row[3],
                       .surface = {row[4], row[5], row[6]},
                       .centre = {row[7], row[8]},
                       .outside = static_cast<std::int64_t>(row[9])});
  }
  std::vector<SurfaceProfile> profiles;
  for (const auto& row : rows_of(folder_, from.mark_of(profiles_name))) {
    profiles.push_back(measures_.empty_profile());
    profiles.back().heights = {row.begin() + 2, row.end()};
  }
  measures_.set_shakings(shakings_of(resolved_, &simulation_));
  measures_.restore(std::move(moments), profiles);
}

void GrainMeasures::record(std::int64_t step, double time, bool regular) {
  measures_.set_shakings(shakings_of(resolved_, &simulation_));
  const GrainSimulation& present = simulation_.present();
  const MeasuredMoment& moment = measures_.record(step, time, present.present_grains(), present.placed_walls());
  if (!table_) return;
  table_->add(step, cells_of(moment), regular);
  std::vector<double> cells{time};
  const std::vector<double>& heights = measures_.surface().heights;
  cells.insert(cells.end(), heights.begin(), heights.end());
  profiles_->add(step, cells, regular);
}

void GrainMeasures::save(Checkpoint& checkpoint) {
  table_->sync();
  profiles_->sync();
  checkpoint.files.push_back(table_->mark());
  checkpoint.files.push_back(profiles_->mark());
}

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

void GrainMeasures::write_files(const CommonOptions& into) const {
  const std::filesystem::path& folder = *into.out;
  if (resolved_.output.picture) {
    Plot plot{.title = resolved_.title, .x = {.label = "x, m"}, .y = {.label = "surface, m"}};
    const auto add = [&](const SurfaceProfile& profile, double time, PlotColour colour) {
      Series series{
          .label = fmt::format("t = {:.4g} s", time), .style = SeriesStyle::line_with_points, .colour = colour};
      for (std::size_t k = 0; k < profile.heights.size(); ++k) series.add(profile.place(k), profile.heights[k]);
      plot.series.push_back(std::move(series));
    };
    add(measures_.surface_before(), measures_.before().time, PlotColour::sky_blue);
    add(measures_.surface(), measures_.moments().back().time, PlotColour::vermilion);
    write_plot(folder, "surface_plot", plot, into.overwrite);
    Series ratio{.label = "", .colour = PlotColour::blue, .column = "void_ratio"};
    for (const MeasuredMoment& moment : measures_.moments()) ratio.add(moment.time, moment.void_ratio);
    if (std::any_of(ratio.y.begin(), ratio.y.end(), [](double e) { return std::isfinite(e); })) {
      Plot history{.title = resolved_.title, .x = {.label = "time, s"}, .y = {.label = "void ratio e"}};
      history.series.push_back(std::move(ratio));
      write_plot(folder, "void_ratio_plot", history, into.overwrite);
    }
  }
  if (!resolved_.measures->cell) return;
  write_fields(folder, "fields", measures_.fields(simulation_.present(), grid_of_fields().first), into.overwrite);
}

void write_probe_paths(const CommonOptions& into, const GrainCase& resolved) {
  constexpr PlotColour colours[] = {PlotColour::blue,     PlotColour::vermilion, PlotColour::green,  PlotColour::orange,
                                    PlotColour::sky_blue, PlotColour::purple,    PlotColour::yellow, PlotColour::black};
  if (!resolved.output.probe_interval) return;
  const auto cells = csv_cells(read_file(*into.out / "history.csv"));
  Plot plot{.title = resolved.title, .x = {.label = "x, m"}, .y = {.label = "y, m"}};
  const auto& names = cells.front();
  for (const Probe& probe : resolved.probes) {
    const auto at = std::find(names.begin(), names.end(), probe.name + "_x_m");
    if (at == names.end() || plot.series.size() == std::size(colours)) continue;
    const auto column = static_cast<std::size_t>(at - names.begin());
    Series series{.label = probe.name, .colour = colours[plot.series.size()]};
    for (std::size_t k = 1; k < cells.size(); ++k)
      series.add(csv_number(cells[k].at(column)).value_or(not_measured),
                 csv_number(cells[k].at(column + 1)).value_or(not_measured));
    plot.series.push_back(std::move(series));
  }
  if (!plot.series.empty()) write_plot(*into.out, "paths_plot", plot, into.overwrite);
}

}  // namespace equidem
