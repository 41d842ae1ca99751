// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/staged_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"
#include "equidem/grains/stages/unbalance.hpp"

namespace equidem {
namespace {

/// Steps between two looks at what ends a stage: at rest takes all contacts, walls are few.
constexpr std::int64_t steps_between_rests = 256, steps_between_places = 16;

constexpr std::size_t numbers_per_stage = 8;

constexpr double energy_rounding = 1e-13;  // of sums over all bodies and contacts

std::size_t index_of(const std::vector<WallState>& walls, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(walls, name, &WallState::name) - walls.begin());
}

void check_walls_of(const GrainStage& stage) {
  const std::vector<std::string> names = names_of(stage.scene.walls);
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(k), names[k]) ==
        names.begin() + static_cast<std::ptrdiff_t>(k))
      continue;
    bad_input(fmt::format("stage '{}' has two walls '{}'", stage.name, names[k]), "a wall goes on by its name",
              "Give each its own name");
  }
  const auto need = [&](const std::string& name) {
    if (std::ranges::find(names, name) != names.end()) return;
    bad_input(fmt::format("stage '{}' ends by the wall '{}'", stage.name, name), "it has no such wall",
              "Name a wall that stands in this stage");
  };
  if (stage.end.displacement > 0) need(stage.end.wall);
  if (stage.end.strain > 0)
    for (const std::string& name : stage.end.walls) need(name);
}

}  // namespace

StagedSimulation::StagedSimulation(std::vector<GrainStage> stages, const GrainOptions& options)
    : AnySimulation(BodyFamily::colliding, options.time_step), stages_(std::move(stages)), options_(options) {
  for (const GrainStage& stage : stages_) check_walls_of(stage);
  present_ = std::make_unique<GrainSimulation>(stages_.front().scene, options_);
  initial_ = present_->energy().initial;
  reports_.push_back({.name = stages_.front().name, .effects = present_->effects()});
  for (const WallState& wall : present_->walls()) places_.push_back(wall.place);
}

void StagedSimulation::advance(std::int64_t steps) {
  if (reports_.back().over && !over()) begin_stage();
  const GrainStage& stage = stages_[number()];
  const std::int64_t first = reports_.back().first, end = first + stage.steps;
  if (step() == end && !reports_.back().over) refuse_endless();
  while (steps > 0 && !reports_.back().over) {
    std::int64_t chunk = std::min(steps, end - step());
    if (stage.end.given()) {
      const std::int64_t stride = stage.end.at_rest() ? steps_between_rests : steps_between_places;
      chunk = std::min(chunk, stride - (step() - first) % stride);
    }
    present_->advance(chunk);
    steps -= chunk;
    look_for_end();
    if (step() == end && !reports_.back().over) refuse_endless();
  }
}

void StagedSimulation::look_for_end() {
  const GrainStage& stage = stages_[number()];
  StageReport& report = reports_.back();
  report.last = step();
  const std::int64_t done = step() - report.first;
  if (!stage.end.given()) {
    report.over = done == stage.steps;
    return;
  }
  const std::int64_t stride = stage.end.at_rest() ? steps_between_rests : steps_between_places;
  if (done % stride != 0 && done != stage.steps) return;
  report.over = report.ended = holds(stage.end);
}

bool StagedSimulation::holds(const StageEnd& end) {
  StageReport& report = reports_.back();
  const std::vector<WallState> walls = present_->walls();
  bool all = true;
  if (end.displacement > 0) {
    const std::size_t w = index_of(walls, end.wall);
    report.displacement = norm(walls[w].place - places_[w]);
    all = all && report.displacement >= end.displacement;
  }
  if (end.strain > 0) {
    const std::size_t a = index_of(walls, end.walls[0]), b = index_of(walls, end.walls[1]);
    const Vec2 across = present_->placed_walls()[a].normal;  // points on lines may lie anywhere along them
    const double before = dot(places_[b] - places_[a], across), now = dot(walls[b].place - walls[a].place, across);
    report.strain = std::abs(now / before - 1);
    all = all && report.strain >= end.strain;
  }
  if (!end.at_rest() || !all) return all;
  const EnergyLedger energy = present_->energy();
  report.kinetic = energy.elastic() > 0 ? energy.kinetic / energy.elastic() : StageEnd::infinite;
  const GrainScene& scene = stages_[number()].scene;
  report.unbalanced = unbalance_of(present_->grains(), present_->contacts(), scene.bonds, scene.gravity).mean;
  return report.kinetic <= end.kinetic && report.unbalanced <= end.unbalanced;
}

void StagedSimulation::refuse_endless() const {
  const GrainStage& stage = stages_[number()];
  const StageReport& report = reports_.back();
  std::vector<std::string> missing;
  if (stage.end.displacement > 0 && report.displacement < stage.end.displacement)
    missing.push_back(fmt::format("wall '{}' has moved {:.3g} m, {:.3g} m are wanted", stage.end.wall,
                                  report.displacement, stage.end.displacement));
  if (stage.end.strain > 0 && report.strain < stage.end.strain)
    missing.push_back(fmt::format("the strain between '{}' and '{}' is {:.3g}, {:.3g} is wanted", stage.end.walls[0],
                                  stage.end.walls[1], report.strain, stage.end.strain));
  if (missing.empty() && report.kinetic > stage.end.kinetic)
    missing.push_back(fmt::format("the kinetic energy is {:.3g} of the elastic one, {:.3g} is rest", report.kinetic,
                                  stage.end.kinetic));
  if (missing.empty() && report.unbalanced > stage.end.unbalanced)
    missing.push_back(fmt::format("the unbalanced force is {:.3g} of the mean contact force, {:.3g} is rest",
                                  report.unbalanced, stage.end.unbalanced));
  throw Error(ErrorKind::computation_failed,
              fmt::format("it has not met its end in {:.6g} s", static_cast<double>(stage.steps) * options_.time_step),
              joined(missing), "Give it a longer duration and go on with --resume, or change what ends it",
              fmt::format("stage '{}'", stage.name));
}

/// The scene of a stage that begins now.
/// \param places of its walls
GrainScene StagedSimulation::scene_of(std::size_t stage, const std::vector<Vec2>& places) const {
  GrainScene scene = stages_[stage].scene;
  const double start = static_cast<double>(reports_.back().first) * options_.time_step;
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    Wall& wall = scene.walls[w];
    wall.end += places[w] - wall.point;
    wall.point = places[w];
    wall.move_x = delayed(wall.move_x, start);
    wall.move_y = delayed(wall.move_y, start);
    if (wall.servo) wall.servo->wanted = delayed(wall.servo->wanted, start);
  }
  return scene;
}

/// The places of the walls of a stage that follows the present one.
std::vector<Vec2> StagedSimulation::places_in(std::size_t stage) const {
  const std::vector<WallState> standing = present_->walls();
  std::vector<Vec2> places;
  for (const Wall& wall : stages_[stage].scene.walls) {
    const std::size_t w = index_of(standing, wall.name);
    places.push_back(w < standing.size() ? standing[w].place : wall.point);
  }
  return places;
}

void StagedSimulation::begin_stage() {
  const EnergyLedger before = energy();
  const std::size_t next = number() + 1;
  places_ = places_in(next);
  reports_.push_back({.name = stages_[next].name, .first = step(), .last = step()});
  auto simulation = [&] {
    try {
      return std::make_unique<GrainSimulation>(scene_of(next, places_), options_, *present_);
    } catch (const Error& error) {
      reports_.pop_back();
      throw error.at(fmt::format("stage '{}'", stages_[next].name));
    }
  }();
  simulation->take_over(*present_);
  present_ = std::move(simulation);
  reports_.back().effects = present_->effects();
  const EnergyLedger after = present_->energy();
  potential_ = before.potential;
  const double stored = before.kinetic + before.elastic(), change = after.kinetic + after.elastic() - stored;
  if (std::abs(change) > energy_rounding * stored) changes_ += change;
}

std::int64_t StagedSimulation::milestone() const {
  return reports_.back().over ? step() : -1;
}

bool StagedSimulation::over() const {
  return reports_.size() == stages_.size() && reports_.back().over;
}

EnergyLedger StagedSimulation::energy() const {
  EnergyLedger ledger = present_->energy();
  ledger.initial = initial_;
  ledger.potential += potential_;
  ledger.work_of_stages = changes_;
  return ledger;
}

SavedState StagedSimulation::save() const {
  SavedState state = present_->save();
  SavedArray stages{.name = "stages", .columns = numbers_per_stage, .values = {}};
  for (const StageReport& report : reports_) {
    stages.values.insert(stages.values.end(), {static_cast<double>(report.first), static_cast<double>(report.last),
                                               report.over ? 1.0 : 0.0, report.ended ? 1.0 : 0.0, report.kinetic,
                                               report.unbalanced, report.strain, report.displacement});
  }
  SavedArray walls{.name = "stage_walls", .columns = 2, .values = {}};
  for (const Vec2 place : places_) walls.values.insert(walls.values.end(), {place.x, place.y});
  state.arrays.push_back(std::move(stages));
  state.arrays.push_back(std::move(walls));
  state.arrays.push_back({"stage_energies", 1, {initial_, potential_, changes_}});
  return state;
}

void StagedSimulation::restore(const SavedState& state) {
  const std::vector<double>&stages = state["stages"], &walls = state["stage_walls"], &sums = state["stage_energies"];
  const std::size_t begun = stages.size() / numbers_per_stage;
  if (begun < 1 || begun > stages_.size() || sums.size() != 3 ||
      walls.size() != 2 * stages_[begun - 1].scene.walls.size())
    bad_input(fmt::format("the saved state has begun {}", counted(static_cast<std::int64_t>(begun), "stage")),
              fmt::format("this run has {} with other walls", stages_.size()),
              "Go on with the case that the state was saved from");
  reports_.clear();
  for (std::size_t k = 0; k < begun; ++k) {
    const double* row = stages.data() + numbers_per_stage * k;
    reports_.push_back({.name = stages_[k].name,
                        .first = static_cast<std::int64_t>(row[0]),
                        .last = static_cast<std::int64_t>(row[1]),
                        .over = row[2] != 0,
                        .ended = row[3] != 0,
                        .kinetic = row[4],
                        .unbalanced = row[5],
                        .strain = row[6],
                        .displacement = row[7]});
    const GrainScene& scene = stages_[k].scene;
    reports_.back().effects = effects_of(scene, options_);
  }
  places_.clear();
  for (std::size_t w = 0; w < walls.size(); w += 2) places_.push_back({walls[w], walls[w + 1]});
  const GrainSimulation first(stages_.front().scene, options_);
  present_ = begun == 1 ? std::make_unique<GrainSimulation>(stages_.front().scene, options_)
                        : std::make_unique<GrainSimulation>(scene_of(begun - 1, places_), options_, first, state);
  present_->restore(state);
  initial_ = sums[0], potential_ = sums[1], changes_ = sums[2];
  // a length or limit that was raised after the stage had reached it
  StageReport& last = reports_.back();
  if (last.over && !last.ended && last.last < last.first + stages_[begun - 1].steps) last.over = false;
}

}  // namespace equidem
