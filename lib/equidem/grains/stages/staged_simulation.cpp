// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/staged_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/contacts/bond_step.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"
#include "equidem/grains/stages/unbalance.hpp"

namespace equidem {
namespace {

/// Steps between two looks at what ends a stage: at rest takes all contacts, walls are few.
constexpr std::int64_t steps_between_rests = 256, steps_between_places = 16;

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

void check_start(const Wall& wall) {
  const Vec2 jump = wall.displacement(0);
  if (jump == Vec2{}) return;
  bad_input(
      fmt::format("wall '{}' would jump by ({:.6g}, {:.6g}) m where its motion begins", wall.name, jump.x, jump.y),
      "a wall that stands moves on from its place", "Let its schedule begin with 0");
}

StagedSimulation::StagedSimulation(std::vector<GrainStage> stages, const GrainOptions& options)
    : AnySimulation(BodyFamily::colliding, options.time_step), stages_(std::move(stages)), options_(options) {
  for (std::size_t k = 0; k < stages_.size(); ++k) {
    if (stages_.size() > 1 && stages_[k].scene.cell)
      bad_input(fmt::format("stage '{}' has a periodic cell", stages_[k].name),
                "a stage does not take over the cell of the one before", "Run one scene, with schedules in the cell");
    check_walls_of(stages_[k]);
    const bool breaks = stages_.front().scene.strengths.has_value();
    if (const auto& made = stages_[k].bonds;
        made && made->strengths.has_value() != breaks && !stages_.front().scene.bonds.empty())
      bad_input(
          fmt::format("of the bonds of stage '{}' and those before it some alone have strengths", stages_[k].name),
          "those without would never break, and none says so", "Give strengths to all bonds, or to none");
    if (const auto& made = stages_[k].bonds) check(*made, stages_.front().scene.grains, options);
    for (const Wall& wall : stages_[k].scene.walls)
      if (k > 0 &&
          std::ranges::find(stages_[k - 1].scene.walls, wall.name, &Wall::name) != stages_[k - 1].scene.walls.end())
        check_start(wall);
  }
  bonds_ = bonds_at_start();
  present_ = std::make_unique<GrainSimulation>(scene_of(0, 0, {}, bonds_), options_);
  initial_ = present_->energy().initial;
  reports_.push_back(
      {.name = stages_.front().name, .effects = present_->effects(), .bonds_made = bonds_.stages.size()});
  for (const WallState& wall : present_->walls()) start_.walls.push_back(wall.place);
}

StagedSimulation::Bonds StagedSimulation::bonds_at_start() const {
  const GrainScene& scene = stages_.front().scene;
  Bonds bonds{scene.bonds, scene.strengths, {}};
  for (GrainBond& bond : bonds.all)
    if (!bond.rest) bond.rest = rest_of(scene.grains.at(bond.i), scene.grains.at(bond.j));
  return bonds_of(0, std::move(bonds), scene.grains, {});
}

StagedSimulation::Bonds StagedSimulation::bonds_of(std::size_t stage, Bonds bonds, std::span<const Grain> grains,
                                                   std::span<const GrainContact> contacts) const {
  if (!stages_[stage].bonds) return bonds;
  const StageBonds& how = *stages_[stage].bonds;
  GrainScene scene;
  scene.grains.assign(grains.begin(), grains.end());
  scene.bonds = make_bonds(grains, contacts, bonds.all, how);
  if (how.strengths) {
    const ContactStrengths made = bond_strengths(scene, *how.strengths);
    if (!bonds.strengths) bonds.strengths.emplace().friction = made.friction;
    bonds.strengths->tension.insert(bonds.strengths->tension.end(), made.tension.begin(), made.tension.end());
    bonds.strengths->shear.insert(bonds.strengths->shear.end(), made.shear.begin(), made.shear.end());
  }
  bonds.all.insert(bonds.all.end(), scene.bonds.begin(), scene.bonds.end());
  bonds.stages.insert(bonds.stages.end(), scene.bonds.size(), stage);
  return bonds;
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
  if (stage.end.given()) {
    const std::int64_t stride = stage.end.at_rest() ? steps_between_rests : steps_between_places;
    if (done % stride != 0 && done != stage.steps) return;
    report.over = report.ended = holds(stage.end);
  } else {
    report.over = done == stage.steps;
  }
  if (report.over) report.servos = present_->servos();
}

bool StagedSimulation::holds(const StageEnd& end) {
  StageReport& report = reports_.back();
  const std::vector<WallState> walls = present_->walls();
  bool all = true;
  if (end.displacement > 0) {
    const std::size_t w = index_of(walls, end.wall);
    report.displacement = norm(walls[w].place - start_.walls[w]);
    all = all && report.displacement >= end.displacement;
  }
  if (end.strain > 0) {
    const std::size_t a = index_of(walls, end.walls[0]), b = index_of(walls, end.walls[1]);
    const Vec2 across = present_->placed_walls()[a].normal;  // points on lines may lie anywhere along them
    const double before = dot(start_.walls[b] - start_.walls[a], across),
                 now = dot(walls[b].place - walls[a].place, across);
    report.strain = std::abs(now / before - 1);
    all = all && report.strain >= end.strain;
  }
  if (!end.at_rest() || !all) return all;
  const EnergyLedger energy = present_->energy();
  report.kinetic = energy.elastic() > 0 ? energy.kinetic / energy.elastic() : StageEnd::infinite;
  const std::vector<GrainBond> left = bonds_left(bonds_.all, present_->breaks());
  report.unbalanced = unbalance_of(*present_, left, stages_[number()].scene.gravity).mean;
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

/// The scene of a stage that begins with a step.
GrainScene StagedSimulation::scene_of(std::size_t stage, std::int64_t first, const Start& start,
                                      const Bonds& bonds) const {
  GrainScene scene = stages_[stage].scene;
  scene.bonds = bonds.all;
  scene.strengths = bonds.strengths;
  const double time = static_cast<double>(first) * options_.time_step;
  for (std::size_t w = 0; w < start.walls.size(); ++w) {
    Wall& wall = scene.walls[w];
    wall.end += start.walls[w] - wall.point;
    wall.point = start.walls[w];
    wall.move_x = delayed(wall.move_x, time);
    wall.move_y = delayed(wall.move_y, time);
    if (wall.servo) wall.servo->wanted = delayed(wall.servo->wanted, time);
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
  Start start{places_in(next), present_->motions(), present_->velocities()};
  Bonds bonds;
  std::unique_ptr<GrainSimulation> simulation;
  try {
    bonds = bonds_of(next, bonds_, present_->grains(), present_->contacts());
    simulation = std::make_unique<GrainSimulation>(scene_of(next, step(), start, bonds), options_, *present_,
                                                   start.motions, start.velocities);
    simulation->take_over(*present_);
  } catch (const Error& error) {
    throw error.at(fmt::format("stage '{}'", stages_[next].name));
  }
  const std::size_t made = bonds.all.size() - bonds_.all.size();
  reports_.push_back({.name = stages_[next].name,
                      .first = step(),
                      .last = step(),
                      .effects = simulation->effects(),
                      .bonds_made = made});
  present_ = std::move(simulation);
  start_ = std::move(start);
  bonds_ = std::move(bonds);
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

}  // namespace equidem
