// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains_measures.hpp"

#include <limits>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"

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
  try {
    return {resolved.scene, *resolved.measures, shakings_of(resolved, nullptr)};
  } catch (const Error& error) {
    throw error.at(resolved.where(resolved.measures->cell ? "measures.cell" : "measures"));
  }
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
  const MeasuredMoment& moment = measures_.record(step, time, present.grains(), present.placed_walls());
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

}  // namespace equidem
