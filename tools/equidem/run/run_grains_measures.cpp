// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains_measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/fields/coarse_fields.hpp"
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

/// When the box begins to shake, s.
double start_of_shaking(const GrainCase& resolved) {
  if (!resolved.shaking) return 0;
  const Schedule& motion = resolved.shaking->motion.displacement;
  return motion.kind == Schedule::Kind::cycles ? motion.start : motion.times.front();
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

}  // namespace

GrainMeasures::GrainMeasures(const GrainCase& resolved)
    : resolved_(resolved),
      start_(box_of(resolved.scene.walls, resolved.scene.grains, 0)),
      shaken_from_(start_of_shaking(resolved)),
      diameter_(mean_diameter(resolved.scene.grains, resolved.scene.clumps)),
      columns_(resolved.measures->columns),
      throws_(resolved.scene.grains.size()) {
  check_cells();
  if (columns_ > 0) return;
  double largest = 0;
  for (const Grain& grain : resolved.scene.grains) largest = std::max(largest, grain.radius);
  constexpr double most = 10'000;
  const double fitting = (start_.inside.high.x - start_.inside.low.x) / (4 * largest);
  columns_ = static_cast<std::size_t>(std::clamp(fitting, 2.0, most));
}

/// Before the run, not after it.
void GrainMeasures::check_cells() const {
  if (!resolved_.measures->cell) return;
  try {
    static_cast<void>(grid_over(start_.inside, *resolved_.measures->cell));
  } catch (const Error& error) {
    throw error.at(resolved_.where("measures.cell"));
  }
}

Vec2 GrainMeasures::displacement(double time) const {
  return resolved_.shaking ? resolved_.shaking->motion.displacement.at(time) * resolved_.shaking->direction : Vec2{};
}

const MeasuredMoment& GrainMeasures::before() const {
  const auto later = std::find_if(moments_.begin() + 1, moments_.end(),
                                  [this](const MeasuredMoment& moment) { return moment.time > shaken_from_; });
  return *(later - 1);
}

void GrainMeasures::open(const std::filesystem::path& folder, bool overwrite,
                         std::optional<std::int64_t> continue_after) {
  folder_ = folder;
  if (continue_after) go_on(*continue_after);
  check_writable(folder / "thrown.csv", overwrite || continue_after);
  const GrowingCsvOptions options{.overwrite = overwrite, .continue_after = continue_after};
  table_.emplace(folder / "measures.csv", columns_of_moments(), options);
  std::vector<std::string> names{"step", "time_s"};
  const double width = (start_.inside.high.x - start_.inside.low.x) / static_cast<double>(columns_);
  for (std::size_t k = 0; k < columns_; ++k)
    names.push_back(fmt::format("x_{:.6g}_m", start_.inside.low.x + width * (static_cast<double>(k) + 0.5)));
  profiles_.emplace(folder / "surface.csv", names, options);
}

void GrainMeasures::go_on(std::int64_t after) {
  for (const auto& row : rows_of(folder_ / "measures.csv", columns_of_moments().size())) {
    const auto step = static_cast<std::int64_t>(row[0]);
    if (step > after) break;
    moments_.push_back({.step = step,
                        .time = row[1],
                        .void_ratio = row[2],
                        .porosity = row[3],
                        .surface = {row[4], row[5], row[6]},
                        .centre = {row[7], row[8]},
                        .thrown = static_cast<std::int64_t>(row[9]),
                        .ever_thrown = static_cast<std::int64_t>(row[10]),
                        .outside = static_cast<std::int64_t>(row[11])});
  }
  const double width = (start_.inside.high.x - start_.inside.low.x) / static_cast<double>(columns_);
  for (const auto& row : rows_of(folder_ / "surface.csv", columns_ + 2))
    if (!moments_.empty() && static_cast<std::int64_t>(row[0]) == before().step)
      before_ = {start_.inside.low.x, width, {row.begin() + 2, row.end()}};
  for (const auto& row : rows_of(folder_ / "thrown.csv", 3)) {
    const auto step = static_cast<std::int64_t>(row[1]);
    if (step <= after) throws_.at(static_cast<std::size_t>(row[0])) = Throw{step, row[2]};
  }
}

void GrainMeasures::record(std::int64_t step, double time, const std::vector<Grain>& grains) {
  const MeasureCase& asked = *resolved_.measures;
  const Vec2 moved = displacement(time);
  const GrainBox box = box_of(resolved_.scene.walls, grains, time);
  const std::vector<char> heap = heap_of(grains, asked.thrown_gap * diameter_);
  MeasuredMoment moment;
  moment.step = step;
  moment.time = time;
  moment.void_ratio = moment.porosity = not_measured;
  std::optional<Region> region;
  if (asked.region) {
    region = Region{asked.region->low + moved, asked.region->high + moved};
  } else {
    region = measured_region(grains, resolved_.scene.clumps, box, heap);
  }
  if (region) {
    const SolidMeasures solids = measure_solids(grains, resolved_.scene.clumps, *region);
    moment.void_ratio = solids.void_ratio;
    moment.porosity = solids.porosity;
  }
  last_ = surface_of(grains, resolved_.scene.clumps, start_.inside.low.x + moved.x, start_.inside.high.x + moved.x,
                     columns_, heap);
  last_.left = start_.inside.low.x;
  for (double& height : last_.heights) height -= moved.y;
  if (moments_.empty() || time <= shaken_from_) before_ = last_;
  moment.surface = shape_of(last_);
  moment.centre = centre_of_mass(grains) - moved;
  for (std::size_t g = 0; g < grains.size(); ++g) {
    if (!heap[g]) {
      ++moment.thrown;
      if (!throws_[g]) throws_[g] = Throw{step, time};
    }
    const Vec2 x = grains[g].position;
    const bool in = x.x >= box.inside.low.x && x.x <= box.inside.high.x && x.y >= box.inside.low.y;
    if (!in) ++moment.outside;
  }
  moment.ever_thrown = std::count_if(throws_.begin(), throws_.end(), [](const auto& t) { return t.has_value(); });
  moments_.push_back(moment);
  if (!table_) return;
  table_->add(step, cells_of(moment));
  std::vector<double> cells{time};
  cells.insert(cells.end(), last_.heights.begin(), last_.heights.end());
  profiles_->add(step, cells);
}

void GrainMeasures::write_thrown() const {
  CsvText text({"grain", "step", "time_s"});
  for (std::size_t g = 0; g < throws_.size(); ++g) {
    if (!throws_[g]) continue;
    text.cell(static_cast<std::int64_t>(g));
    text.cell(throws_[g]->step);
    text.cell(throws_[g]->time);
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
