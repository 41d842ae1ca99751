// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/staged_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/contacts/bond_step.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {
namespace {

std::vector<std::size_t> idle(const std::vector<char>& held) {
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < held.size(); ++k)
    if (held[k] == 0) numbers.push_back(k);
  return numbers;
}

}  // namespace

bool BodyChoice::holds(const Grain& grain) const {
  if (!kinds.empty() && std::ranges::find(kinds, grain.kind) == kinds.end()) return false;
  if (!box) return true;
  const Vec2 at = grain.position;
  return box->low.x <= at.x && at.x <= box->high.x && box->low.y <= at.y && at.y <= box->high.y;
}

ChangedBodies change_bodies(const PresentBodies& before, const StageBodies& how, std::size_t first_added) {
  ChangedBodies changed;
  const auto put = [&](std::size_t number, const Grain& grain, std::int32_t origin) {
    changed.now.numbers.push_back(number);
    changed.now.grains.push_back(grain);
    changed.origins.push_back(origin);
  };
  std::vector<char> removes(how.removed.size(), 0), renames(how.renamed.size(), 0);
  for (std::size_t k = 0; k < before.grains.size(); ++k) {
    const Grain& grain = before.grains[k];
    bool goes = false;
    for (std::size_t c = 0; c < how.removed.size(); ++c)
      if (how.removed[c].holds(grain)) {
        goes = true;
        removes[c] = 1;
      }
    if (goes) {
      ++changed.removed;
      continue;
    }
    put(before.numbers[k], grain, static_cast<std::int32_t>(k));
    Grain& kept = changed.now.grains.back();
    for (std::size_t c = 0; c < how.renamed.size(); ++c)
      if (how.renamed[c].which.holds(kept)) kept.kind = how.renamed[c].kinds[before.numbers[k]], renames[c] = 1;
    if (kept.kind != grain.kind) ++changed.renamed;
  }
  changed.idle_removals = idle(removes);
  changed.idle_renamings = idle(renames);
  for (std::size_t k = 0; k < how.added.size(); ++k) put(first_added + k, how.added[k], -1);
  if (changed.now.grains.empty())
    bad_input("all bodies are removed", "there is nothing left to move", "Remove fewer, or add some");
  return changed;
}

namespace {

/// Steps between two looks at what ends a stage: at rest takes all contacts, walls are few.
constexpr std::int64_t steps_between_rests = 256, steps_between_places = 16;

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
  if (stage.end.of_cell && !(stage.scene.cell && stage.scene.cell->along == PeriodicCell::Along::xy))
    bad_input(fmt::format("stage '{}' ends by the strain of a periodic cell", stage.name),
              "there is no cell that repeats along x and y", "Name two walls between which the strain is");
  if (stage.end.strain > 0 && !stage.end.of_cell)
    for (const std::string& name : stage.end.walls) need(name);
}

double component_of(const Voigt& strain, StageEnd::CellStrain which) {
  switch (which) {
    case StageEnd::CellStrain::xx:
      return strain.xx;
    case StageEnd::CellStrain::yy:
      return strain.yy;
    case StageEnd::CellStrain::xy:
      break;
  }
  return strain.xy;
}

}  // namespace

Effects effects_of(const std::vector<GrainStage>& stages, const GrainOptions& options) {
  GrainScene all = stages.front().scene;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (const GrainStage& stage : stages) {
    if (&stage != &stages.front()) {
      append(all.pairs, stage.scene.pairs);
      append(all.walls, stage.scene.walls);
      append(all.grains, stage.bodies.added);
      if (!all.weighs()) all.gravity = stage.scene.gravity;
      if (stage.scene.cell && stage.scene.cell->deforms()) all.cell = stage.scene.cell;
    }
    if (!stage.bonds) continue;
    all.bonds.push_back(stage.bonds->like);
    if (stage.bonds->strengths) all.strengths.emplace();
  }
  return effects_of(all, options);
}

std::vector<std::string> active_effects(const Effects& effects) {
  std::vector<std::string> names;
  for (const Effects::Entry& entry : effects.entries)
    if (entry.active) names.push_back(entry.name);
  return names;
}

void check_start(const Wall& wall) {
  const Vec2 jump = wall.displacement(0);
  if (jump == Vec2{}) return;
  bad_input(
      fmt::format("wall '{}' would jump by ({:.6g}, {:.6g}) m where its motion begins", wall.name, jump.x, jump.y),
      "a wall that stands moves on from its place", "Let its schedule begin with 0");
}

StagedSimulation::StagedSimulation(std::vector<GrainStage> stages, const GrainOptions& options)
    : AnySimulation(BodyFamily::colliding, options.time_step), stages_(std::move(stages)), options_(options) {
  const GrainStage& first = stages_.front();
  options_.reference_length = reference_length(first.scene, options);
  if (first.bodies.change())
    bad_input(fmt::format("stage '{}' changes the bodies", first.name), "it is the first, and begins with the scene",
              "Give the scene those bodies");
  for (std::size_t k = 0; k < stages_.size(); ++k) {
    if (stages_[k].scene.cell.has_value() != first.scene.cell.has_value())
      bad_input(fmt::format("of the stages '{}' and '{}' one has a periodic cell", first.name, stages_[k].name),
                "a cell neither comes nor goes", "Give all stages the cell, or none");
    check_walls_of(stages_[k]);
    const bool breaks = first.scene.strengths.has_value();
    if (const auto& made = stages_[k].bonds;
        made && made->strengths.has_value() != breaks && !first.scene.bonds.empty())
      bad_input(
          fmt::format("of the bonds of stage '{}' and those before it some alone have strengths", stages_[k].name),
          "those without would never break, and none says so", "Give strengths to all bonds, or to none");
    if (const auto& made = stages_[k].bonds) check(*made, first.scene.grains, options_);
    if (k == 0) continue;
    const std::vector<std::int32_t> origins = wall_origins(k);
    for (std::size_t w = 0; w < origins.size(); ++w)
      if (origins[w] >= 0) check_start(stages_[k].scene.walls[w]);
  }
  start_ = start_of_first();
  bonds_ = bonds_at_start();
  present_ = std::make_unique<GrainSimulation>(scene_of(std::array{std::int64_t{0}}, start_, bonds_), options_);
  effects_ = effects_of(stages_, options_);
  initial_ = present_->energy().initial;
  reports_.push_back(
      {.name = first.name, .effects = active_effects(present_->effects()), .bonds_made = bonds_.stages.size()});
  for (const WallState& wall : present_->walls()) start_.walls.push_back(wall.place);
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
  if (!report.over) return;
  report.servos = present_->servos();
  if (const auto cell = present_->cell()) report.cell_servos = cell->servos;
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
  if (end.strain > 0 && end.of_cell) {
    report.strain =
        std::abs(component_of(present_->cell()->strain, *end.of_cell) - component_of(start_.strain, *end.of_cell));
    all = all && report.strain >= end.strain;
  } else if (end.strain > 0) {
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
  report.unbalanced = unbalance_of(*present_, holding_bonds().bonds, stages_[number()].scene.gravity).mean;
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
    missing.push_back(fmt::format("the strain {} is {:.3g}, {:.3g} is wanted",
                                  stage.end.of_cell
                                      ? fmt::format("{} of the cell", to_string(*stage.end.of_cell))
                                      : fmt::format("between '{}' and '{}'", stage.end.walls[0], stage.end.walls[1]),
                                  report.strain, stage.end.strain));
  if (missing.empty() && report.kinetic > stage.end.kinetic)
    missing.push_back(fmt::format("the kinetic energy is {:.3g} of the elastic one, {:.3g} is rest", report.kinetic,
                                  stage.end.kinetic));
  if (missing.empty() && report.unbalanced > stage.end.unbalanced)
    missing.push_back(fmt::format("the unbalanced force is {:.3g} of the mean contact force, {:.3g} is rest",
                                  report.unbalanced, stage.end.unbalanced));
  throw Error(ErrorKind::computation_failed,
              fmt::format("it has not met its end in {:.6g} s", static_cast<double>(stage.steps) * options_.time_step),
              joined(missing),
              "Give it a longer duration and go on with --resume, or change what ends it and run it anew",
              stage.where());
}

std::vector<BondBreak> StagedSimulation::breaks() const {
  std::vector<BondBreak> here = present_->breaks(), all;
  const std::vector<std::size_t> numbers_of_bonds = bonds_between(numbers(), bonds_).numbers;
  for (BondBreak& event : here) event.bond = numbers_of_bonds[event.bond];
  std::ranges::merge(past_breaks_, here, std::back_inserter(all), {}, &BondBreak::step, &BondBreak::step);
  return all;
}

StagedSimulation::HoldingBonds StagedSimulation::holding_bonds() const {
  const SceneBonds between = bonds_between(numbers(), bonds_);
  std::vector<char> broken(between.bonds.size(), 0);
  for (const BondBreak& event : present_->breaks()) broken[event.bond] = 1;
  HoldingBonds holding;
  for (std::size_t b = 0; b < broken.size(); ++b) {
    if (broken[b] != 0) continue;
    holding.bonds.push_back(between.bonds[b]);
    if (!bonds_.strengths) continue;
    holding.strengths.tension.push_back(bonds_.strengths->tension[between.numbers[b]]);
    holding.strengths.shear.push_back(bonds_.strengths->shear[between.numbers[b]]);
  }
  return holding;
}

std::vector<DiscMotion> StagedSimulation::of_run(const std::vector<DiscMotion>& here) const {
  std::vector<DiscMotion> all(first_added(stages_.size()), not_there);
  for (std::size_t k = 0; k < here.size(); ++k) all[numbers()[k]] = here[k];
  return all;
}

std::vector<BodyContact> StagedSimulation::body_contacts() const {
  std::vector<BodyContact> contacts = present_->body_contacts();
  const auto number = [&](std::int32_t place) { return static_cast<std::int32_t>(numbers()[place]); };
  for (BodyContact& contact : contacts) {
    contact.i = number(contact.i);
    if (contact.j >= 0) contact.j = number(contact.j);
  }
  return contacts;
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
