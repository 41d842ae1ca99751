// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"

namespace equidem {
namespace {

constexpr std::size_t numbers_per_stage = 8, numbers_of_made_bond = 9, numbers_of_servo_report = 7;

std::vector<double> numbers_of_reports(const std::vector<StageReport>& reports) {
  std::vector<double> numbers;
  for (const StageReport& report : reports) {
    numbers.insert(numbers.end(),
                   {static_cast<double>(report.first), static_cast<double>(report.last), report.over ? 1.0 : 0.0,
                    report.ended ? 1.0 : 0.0, report.kinetic, report.unbalanced, report.strain, report.displacement});
  }
  return numbers;
}

std::vector<double> numbers_of_servos(const std::vector<StageReport>& reports) {
  std::vector<double> numbers;
  for (std::size_t k = 0; k < reports.size(); ++k)
    for (const ServoReport& servo : reports[k].servos)
      numbers.insert(numbers.end(), {static_cast<double>(k), servo.touched ? 1.0 : 0.0, servo.reached ? 1.0 : 0.0,
                                     servo.wanted, servo.force, servo.overshoot, servo.mean_error});
  return numbers;
}

/// A report of a stage, without its effects.
StageReport report_of(const std::string& name, const double* row) {
  return {.name = name,
          .first = static_cast<std::int64_t>(row[0]),
          .last = static_cast<std::int64_t>(row[1]),
          .over = row[2] != 0,
          .ended = row[3] != 0,
          .kinetic = row[4],
          .unbalanced = row[5],
          .strain = row[6],
          .displacement = row[7]};
}

[[noreturn]] void refuse_state(const std::string& what, const std::string& why) {
  bad_input(what, why, "Go on with the case that the state was saved from");
}

/// Reports of servo walls; names are those of the walls of the stage, in their order.
void take_servos(const std::vector<double>& numbers, const std::vector<GrainStage>& stages,
                 std::vector<StageReport>& reports) {
  for (std::size_t at = 0; at + numbers_of_servo_report <= numbers.size(); at += numbers_of_servo_report) {
    const double* n = numbers.data() + at;
    const auto is_count = [](double number) { return number >= 0 && number <= 1e15 && number == std::floor(number); };
    if (!is_count(n[0]) || !is_count(n[1]) || !is_count(n[2]))
      refuse_state("the saved state has a bond without a stage or a disc", "its file may be damaged");
    const auto stage = static_cast<std::size_t>(n[0]);
    if (stage >= reports.size())
      refuse_state("the saved state reports servo walls of a stage to come", "it is damaged");
    std::vector<ServoReport>& servos = reports[stage].servos;
    std::size_t skip = servos.size();
    for (const Wall& wall : stages[stage].scene.walls) {
      if (!wall.servo || skip-- > 0) continue;
      servos.push_back({.wall = wall.name,
                        .mirror = wall.servo->mirror,
                        .touched = n[1] != 0,
                        .reached = n[2] != 0,
                        .wanted = n[3],
                        .force = n[4],
                        .overshoot = n[5],
                        .mean_error = n[6]});
      break;
    }
  }
}

}  // namespace

SavedState StagedSimulation::save() const {
  SavedState state = present_->save();
  SavedArray walls{.name = "stage_walls", .columns = 2, .values = {}};
  for (const Vec2 place : start_.walls) walls.values.insert(walls.values.end(), {place.x, place.y});
  SavedArray made{.name = "stage_bonds", .columns = numbers_of_made_bond, .values = {}};
  const std::size_t first = bonds_.all.size() - bonds_.stages.size();
  for (std::size_t k = 0; k < bonds_.stages.size(); ++k) {
    const GrainBond& bond = bonds_.all[first + k];
    made.values.insert(made.values.end(),
                       {static_cast<double>(bonds_.stages[k]), static_cast<double>(bond.i), static_cast<double>(bond.j),
                        bond.rest->branch.x, bond.rest->branch.y, bond.rest->angle_i, bond.rest->angle_j,
                        bonds_.strengths ? bonds_.strengths->tension[first + k] : 0,
                        bonds_.strengths ? bonds_.strengths->shear[first + k] : 0});
  }
  state.arrays.push_back({"stages", numbers_per_stage, numbers_of_reports(reports_)});
  state.arrays.push_back(std::move(walls));
  state.arrays.push_back({"stage_motions", 3, numbers_of(start_.motions)});
  state.arrays.push_back({"stage_velocities", 3, numbers_of(start_.velocities)});
  state.arrays.push_back(std::move(made));
  state.arrays.push_back({"stage_servos", numbers_of_servo_report, numbers_of_servos(reports_)});
  state.arrays.push_back({"stage_energies", 1, {initial_, potential_, changes_}});
  return state;
}

StagedSimulation::Bonds StagedSimulation::bonds_in(const SavedState& state, std::size_t begun) const {
  const GrainScene& scene = stages_.front().scene;
  const std::vector<double>& made = state["stage_bonds"];
  Bonds bonds = bonds_at_start();
  const std::size_t own = scene.bonds.size();
  bonds.all.resize(own);
  bonds.stages.clear();
  if (bonds.strengths) bonds.strengths->tension.resize(own), bonds.strengths->shear.resize(own);
  for (std::size_t at = 0; at + numbers_of_made_bond <= made.size(); at += numbers_of_made_bond) {
    const double* n = made.data() + at;
    const auto stage = static_cast<std::size_t>(n[0]);
    if (stage >= begun || !stages_[stage].bonds)
      refuse_state(fmt::format("the saved state has bonds made in stage {}", stage), "this run makes none there");
    const StageBonds& how = *stages_[stage].bonds;
    GrainBond& bond = bonds.all.emplace_back(how.like);
    bond.i = static_cast<std::size_t>(n[1]);
    bond.j = static_cast<std::size_t>(n[2]);
    bond.rest = BondRest{{n[3], n[4]}, n[5], n[6]};
    bonds.stages.push_back(stage);
    if (!how.strengths) continue;
    if (!bonds.strengths) bonds.strengths.emplace().friction = how.strengths->friction;
    bonds.strengths->tension.push_back(n[7]);
    bonds.strengths->shear.push_back(n[8]);
  }
  return bonds;
}

void StagedSimulation::restore(const SavedState& state) {
  const std::vector<double>&stages = state["stages"], &walls = state["stage_walls"], &sums = state["stage_energies"];
  const std::size_t begun = stages.size() / numbers_per_stage;
  if (begun < 1 || begun > stages_.size() || sums.size() != 3 ||
      walls.size() != 2 * stages_[begun - 1].scene.walls.size())
    refuse_state(fmt::format("the saved state has begun {}", counted(static_cast<std::int64_t>(begun), "stage")),
                 fmt::format("this run has {} with other walls", stages_.size()));
  const Bonds bonds = bonds_in(state, begun);
  std::vector<StageReport> reports;
  for (std::size_t k = 0; k < begun; ++k) {
    StageReport& report = reports.emplace_back(report_of(stages_[k].name, stages.data() + numbers_per_stage * k));
    report.bonds_made = static_cast<std::size_t>(std::ranges::count(bonds.stages, k));
    GrainScene scene = stages_[k].scene;
    const auto later = std::ranges::count_if(bonds.stages, [&](std::size_t stage) { return stage > k; });
    scene.bonds.assign(bonds.all.begin(), bonds.all.end() - later);
    scene.strengths = bonds.strengths;
    report.effects = effects_of(scene, options_);
  }
  take_servos(state["stage_servos"], stages_, reports);
  Start start{{}, motions_of(state["stage_motions"]), motions_of(state["stage_velocities"])};
  for (std::size_t w = 0; w < walls.size(); w += 2) start.walls.push_back({walls[w], walls[w + 1]});
  // the first stage begins with the scene, and its order of bodies is that of all stages
  auto simulation =
      std::make_unique<GrainSimulation>(scene_of(0, 0, {}, begun == 1 ? bonds : bonds_at_start()), options_);
  if (begun > 1)
    simulation = std::make_unique<GrainSimulation>(scene_of(begun - 1, reports.back().first, start, bonds), options_,
                                                   *simulation, start.motions, start.velocities);
  simulation->restore(state);
  present_ = std::move(simulation);
  reports_ = std::move(reports);
  start_ = std::move(start);
  bonds_ = bonds;
  initial_ = sums[0], potential_ = sums[1], changes_ = sums[2];
  // a length or limit that was raised after the stage had reached it
  StageReport& last = reports_.back();
  if (last.over && !last.ended && last.last < last.first + stages_[begun - 1].steps) {
    last.over = false;
    last.servos.clear();
  }
}

}  // namespace equidem
