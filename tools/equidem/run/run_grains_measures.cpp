// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains_measures.hpp"

#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {
namespace {

const std::vector<std::string>& columns_of_moments() {
  static const std::vector<std::string> columns{"step",
                                                "time_s",
                                                "void_ratio",
                                                "porosity",
                                                "surface_height_m",
                                                "surface_slope",
                                                "surface_roughness_m",
                                                "centre_x_m",
                                                "centre_y_m",
                                                "thrown",
                                                "ever_thrown",
                                                "outside"};
  return columns;
}

std::vector<double> cells_of(const MeasuredMoment& m) {
  return {m.time,
          m.void_ratio,
          m.porosity,
          m.surface.height,
          m.surface.slope,
          m.surface.roughness,
          m.centre.x,
          m.centre.y,
          static_cast<double>(m.thrown),
          static_cast<double>(m.ever_thrown),
          static_cast<double>(m.outside)};
}

/// Rows of numbers of a table that the program wrote.
std::vector<std::vector<double>> rows_of(const std::filesystem::path& path, std::size_t columns) {
  auto cells = csv_cells(read_file(path));
  std::vector<std::vector<double>> rows;
  for (std::size_t k = 1; k < cells.size(); ++k) {
    if (cells[k].size() != columns)
      bad_input(fmt::format("a row of '{}' has {} cells", path.string(), cells[k].size()),
                fmt::format("the table has {} columns", columns), "Start the run afresh");
    rows.emplace_back();
    for (const std::string& cell : cells[k]) rows.back().push_back(csv_number(cell).value_or(not_measured));
  }
  return rows;
}

BoxMeasures measures_of(const GrainCase& resolved) {
  try {
    return {resolved.scene, *resolved.measures, resolved.shaking};
  } catch (const Error& error) {
    throw error.at(resolved.where(resolved.measures->cell ? "measures.cell" : "measures"));
  }
}

}  // namespace

GrainMeasures::GrainMeasures(const GrainCase& resolved, const GrainSimulation& simulation)
    : resolved_(resolved), simulation_(simulation), measures_(measures_of(resolved)) {}

void GrainMeasures::open(const std::filesystem::path& folder, bool overwrite,
                         std::optional<std::int64_t> continue_after) {
  folder_ = folder;
  if (continue_after) go_on(*continue_after);
  check_writable(folder / "thrown.csv", overwrite || continue_after);
  const GrowingCsvOptions options{.overwrite = overwrite, .continue_after = continue_after};
  table_.emplace(folder / "measures.csv", columns_of_moments(), options);
  std::vector<std::string> names{"step", "time_s"};
  const SurfaceProfile profile = measures_.empty_profile();
  for (std::size_t k = 0; k < measures_.options().columns; ++k)
    names.push_back(fmt::format("x_{:.6g}_m", profile.place(k)));
  profiles_.emplace(folder / "surface.csv", names, options);
}

void GrainMeasures::go_on(std::int64_t after) {
  std::vector<MeasuredMoment> moments;
  for (const auto& row : rows_of(folder_ / "measures.csv", columns_of_moments().size())) {
    const auto step = static_cast<std::int64_t>(row[0]);
    if (step > after) break;
    moments.push_back({.step = step,
                       .time = row[1],
                       .void_ratio = row[2],
                       .porosity = row[3],
                       .surface = {row[4], row[5], row[6]},
                       .centre = {row[7], row[8]},
                       .thrown = static_cast<std::int64_t>(row[9]),
                       .ever_thrown = static_cast<std::int64_t>(row[10]),
                       .outside = static_cast<std::int64_t>(row[11])});
  }
  auto throws = measures_.throws();
  for (const auto& row : rows_of(folder_ / "thrown.csv", 3)) {
    const auto step = static_cast<std::int64_t>(row[1]);
    if (step <= after) throws.at(static_cast<std::size_t>(row[0])) = FirstThrow{step, row[2]};
  }
  measures_.restore(std::move(moments), {}, throws);
  SurfaceProfile profile = measures_.empty_profile();
  for (const auto& row : rows_of(folder_ / "surface.csv", measures_.options().columns + 2))
    if (!measures_.moments().empty() && static_cast<std::int64_t>(row[0]) == measures_.before().step)
      profile.heights = {row.begin() + 2, row.end()};
  measures_.restore(measures_.moments(), profile, std::move(throws));
}

void GrainMeasures::record(std::int64_t step, double time) {
  const MeasuredMoment& moment = measures_.record(step, time, simulation_.grains());
  if (!table_) return;
  table_->add(step, cells_of(moment));
  std::vector<double> cells{time};
  const std::vector<double>& heights = measures_.surface().heights;
  cells.insert(cells.end(), heights.begin(), heights.end());
  profiles_->add(step, cells);
}

void GrainMeasures::write_thrown() const {
  CsvText text({"grain", "step", "time_s"});
  const auto& throws = measures_.throws();
  for (std::size_t g = 0; g < throws.size(); ++g) {
    if (!throws[g]) continue;
    text.cell(static_cast<std::int64_t>(g));
    text.cell(throws[g]->step);
    text.cell(throws[g]->time);
    text.end_row();
  }
  write_file(folder_ / "thrown.csv", text.text(), true);
}

void GrainMeasures::sync() {
  if (!table_) return;
  write_thrown();
  table_->sync();
  profiles_->sync();
}

}  // namespace equidem
