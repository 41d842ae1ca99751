// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"

namespace equidem {
namespace {

constexpr std::size_t numbers_per_stage = 11, numbers_of_made_bond = 9, numbers_of_servo_report = 9,
                      numbers_of_cell_start = 8, numbers_of_idle_choice = 3, numbers_of_cell_servo_report = 7;

/// \param effects all that there are, in the order of their bits
std::vector<double> numbers_of_reports(const std::vector<StageReport>& reports, const Effects& effects) {
  std::vector<double> numbers;
  for (const StageReport& report : reports) {
    double bits = 0;
    for (std::size_t k = 0; k < effects.entries.size(); ++k)
      if (std::ranges::find(report.effects, effects.entries[k].name) != report.effects.end())
        bits += std::ldexp(1.0, static_cast<int>(k));
    numbers.insert(numbers.end(),
                   {static_cast<double>(report.first), static_cast<double>(report.last), report.over ? 1.0 : 0.0,
                    report.ended ? 1.0 : 0.0, report.kinetic, report.unbalanced, report.strain, report.displacement,
                    static_cast<double>(report.removed), static_cast<double>(report.renamed), bits});
  }
  return numbers;
}

std::vector<std::string> effects_of_bits(const Effects& effects, double bits) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < effects.entries.size(); ++k)
    if (std::fmod(std::floor(std::ldexp(bits, -static_cast<int>(k))), 2) == 1) names.push_back(effects.entries[k].name);
  return names;
}

std::vector<double> numbers_of_servos(const std::vector<StageReport>& reports) {
  std::vector<double> numbers;
  for (std::size_t k = 0; k < reports.size(); ++k)
    for (const ServoReport& servo : reports[k].servos)
      numbers.insert(numbers.end(),
                     {static_cast<double>(k), servo.touched ? 1.0 : 0.0, servo.reached ? 1.0 : 0.0, servo.wanted,
                      servo.force, servo.max_speed, servo.overshoot, servo.peak, servo.mean_error});
  return numbers;
}

std::vector<double> numbers_of_cell_servos(const std::vector<StageReport>& reports) {
  std::vector<double> numbers;
  for (std::size_t k = 0; k < reports.size(); ++k)
    for (const CellServoReport& servo : reports[k].cell_servos)
      numbers.insert(numbers.end(),
                     {static_cast<double>(k), servo.component == "xx" ? 0.0 : 1.0, servo.reached ? 1.0 : 0.0,
                      servo.wanted, servo.stress, servo.overshoot, servo.mean_error});
  return numbers;
}

std::vector<double> numbers_of_idle(const std::vector<StageReport>& reports) {
  std::vector<double> numbers;
  for (std::size_t k = 0; k < reports.size(); ++k)
    for (const auto& [renames, choices] :
         {std::pair{0.0, &reports[k].idle_removals}, {1.0, &reports[k].idle_renamings}})
      for (const std::size_t choice : *choices)
        numbers.insert(numbers.end(), {static_cast<double>(k), renames, static_cast<double>(choice)});
  return numbers;
}

/// A report of a stage, without what it added and made.
StageReport report_of(const std::string& name, const double* row, const Effects& effects) {
  return {.name = name,
          .first = static_cast<std::int64_t>(row[0]),
          .last = static_cast<std::int64_t>(row[1]),
          .over = row[2] != 0,
          .ended = row[3] != 0,
          .kinetic = row[4],
          .unbalanced = row[5],
          .strain = row[6],
          .displacement = row[7],
          .effects = effects_of_bits(effects, row[10]),
          .removed = static_cast<std::size_t>(row[8]),
          .renamed = static_cast<std::size_t>(row[9])};
}

[[noreturn]] void refuse_state(const std::string& what, const std::string& why) {
  bad_input(what, why, "Go on with the case that the state was saved from");
}

/// Whether a number counts something of which there are `end`.
bool is_below(double number, std::size_t end) {
  return number >= 0 && number < static_cast<double>(end) && number == std::floor(number);
}

void take_cell_servos(const std::vector<double>& numbers, std::vector<StageReport>& reports) {
  for (std::size_t at = 0; at + numbers_of_cell_servo_report <= numbers.size(); at += numbers_of_cell_servo_report) {
    const double* n = numbers.data() + at;
    if (!is_below(n[0], reports.size()))
      refuse_state("the saved state reports stresses of a cell in a stage to come", "its file may be damaged");
    reports[static_cast<std::size_t>(n[0])].cell_servos.push_back({.component = n[1] == 0 ? "xx" : "yy",
                                                                   .reached = n[2] != 0,
                                                                   .wanted = n[3],
                                                                   .stress = n[4],
                                                                   .overshoot = n[5],
                                                                   .mean_error = n[6]});
  }
}

/// Choices of bodies that held none.
void take_idle(const std::vector<double>& numbers, const std::vector<GrainStage>& stages,
               std::vector<StageReport>& reports) {
  for (std::size_t at = 0; at + numbers_of_idle_choice <= numbers.size(); at += numbers_of_idle_choice) {
    const double* n = numbers.data() + at;
    if (!is_below(n[0], reports.size()) || !is_below(n[1], 2))
      refuse_state("the saved state tells of choices of bodies in a stage to come", "its file may be damaged");
    const auto stage = static_cast<std::size_t>(n[0]);
    const StageBodies& how = stages[stage].bodies;
    if (!is_below(n[2], n[1] == 0 ? how.removed.size() : how.renamed.size()))
      refuse_state(
          fmt::format("the saved state tells of choices of bodies that stage '{}' does not make", reports[stage].name),
          "its file may be damaged");
    (n[1] == 0 ? reports[stage].idle_removals : reports[stage].idle_renamings)
        .push_back(static_cast<std::size_t>(n[2]));
  }
}

/// Reports of servo walls; names are those of the walls of the stage, in their order.
void take_servos(const std::vector<double>& numbers, const std::vector<GrainStage>& stages,
                 std::vector<StageReport>& reports) {
  for (std::size_t at = 0; at + numbers_of_servo_report <= numbers.size(); at += numbers_of_servo_report) {
    const double* n = numbers.data() + at;
    if (!is_below(n[0], reports.size()))
      refuse_state("the saved state reports servo walls of a stage to come", "its file may be damaged");
    const auto stage = static_cast<std::size_t>(n[0]);
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
                        .max_speed = n[5],
                        .overshoot = n[6],
                        .peak = n[7],
                        .mean_error = n[8]});
      break;
    }
  }
}

}  // namespace

SavedState StagedSimulation::save() const {
  SavedState state = present_->save();
  SavedArray walls{.name = "stage_walls", .columns = 2, .values = {}};
  for (const Vec2 place : start_.walls) walls.values.insert(walls.values.end(), {place.x, place.y});
  SavedArray cell{.name = "stage_cell", .columns = 1, .values = {}};
  if (start_.cell)
    cell.values = {start_.cell->width,    start_.cell->height, start_.cell->shift, start_.cell->corner.x,
                   start_.cell->corner.y, start_.strain.xx,    start_.strain.yy,   start_.strain.xy};
  SavedArray bodies{.name = "stage_bodies", .columns = 2, .values = {}};
  std::vector<DiscMotion> places, velocities;
  for (const std::size_t k : present_->order())
    bodies.values.insert(bodies.values.end(),
                         {static_cast<double>(numbers()[k]), static_cast<double>(start_.bodies.grains[k].kind)});
  for (std::size_t k = 0; number() > 0 && k < start_.bodies.grains.size(); ++k) {
    const Grain& grain = start_.bodies.grains[k];
    places.push_back({grain.position, grain.angle});
    velocities.push_back({grain.velocity, grain.spin});
  }
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
  state.arrays.push_back({"stages", numbers_per_stage, numbers_of_reports(reports_, present_->effects())});
  state.arrays.push_back(std::move(walls));
  state.arrays.push_back(std::move(cell));
  state.arrays.push_back(std::move(bodies));
  state.arrays.push_back({"stage_motions", 3, numbers_of(places)});
  state.arrays.push_back({"stage_velocities", 3, numbers_of(velocities)});
  state.arrays.push_back(std::move(made));
  state.arrays.push_back({"stage_breaks", numbers_per_break, numbers_of(past_breaks_)});
  state.arrays.push_back({"stage_servos", numbers_of_servo_report, numbers_of_servos(reports_)});
  state.arrays.push_back({"stage_cell_servos", numbers_of_cell_servo_report, numbers_of_cell_servos(reports_)});
  state.arrays.push_back({"stage_idle", numbers_of_idle_choice, numbers_of_idle(reports_)});
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
    if (!is_below(n[0], begun) || !stages_[static_cast<std::size_t>(n[0])].bonds)
      refuse_state(fmt::format("the saved state has bonds made in stage {}", n[0]), "this run makes none there");
    const auto stage = static_cast<std::size_t>(n[0]);
    if (!is_below(n[1], first_added(stage + 1)) || !is_below(n[2], first_added(stage + 1)))
      refuse_state(fmt::format("the saved state has a bond of the bodies {} and {} in stage '{}'", n[1], n[2],
                               stages_[stage].name),
                   fmt::format("this run has {} until then", first_added(stage + 1)));
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

/// \param[out] order of the bodies in the loops
StagedSimulation::Start StagedSimulation::start_in(const SavedState& state, std::size_t begun,
                                                   std::vector<std::size_t>& order) const {
  const std::vector<double>&walls = state["stage_walls"], &bodies = state["stage_bodies"], &cell = state["stage_cell"];
  const std::vector<DiscMotion> places = motions_of(state["stage_motions"]),
                                velocities = motions_of(state["stage_velocities"]);
  const std::size_t count = bodies.size() / 2;
  Start start{.walls = {}, .bodies = {}, .cell = stages_[begun - 1].scene.cell};
  std::vector<std::pair<std::size_t, int>> present;  // number and kind
  for (std::size_t k = 0; k < count; ++k) {
    if (!is_below(bodies[2 * k], first_added(begun)))
      refuse_state(fmt::format("the saved state has a body {}", bodies[2 * k]),
                   fmt::format("this run has {} until then", first_added(begun)));
    if (!is_below(bodies[2 * k + 1], static_cast<std::size_t>(stages_[begun - 1].scene.kinds)))
      refuse_state(fmt::format("the saved state has a body of kind {}", bodies[2 * k + 1]),
                   fmt::format("stage '{}' has {}", stages_[begun - 1].name, stages_[begun - 1].scene.kinds));
    present.emplace_back(static_cast<std::size_t>(bodies[2 * k]), static_cast<int>(bodies[2 * k + 1]));
  }
  std::ranges::sort(present);
  const auto same_number = [](const auto& a, const auto& b) { return a.first == b.first; };
  const std::size_t moved = begun > 1 ? count : 0;
  if (std::ranges::adjacent_find(present, same_number) != present.end() || places.size() != moved ||
      velocities.size() != moved || cell.size() != (start.cell ? numbers_of_cell_start : 0))
    refuse_state(fmt::format("the saved state is of {} bodies", count), "its parts do not belong together");
  for (const auto& [number, kind] : present) {
    const std::size_t k = start.bodies.numbers.size();
    start.bodies.numbers.push_back(number);
    Grain& grain = start.bodies.grains.emplace_back(body_of_run(number));
    grain.kind = kind;
    if (begun == 1) continue;
    grain.position = places[k].u, grain.angle = places[k].theta;
    grain.velocity = velocities[k].u, grain.spin = velocities[k].theta;
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto at = std::ranges::lower_bound(start.bodies.numbers, static_cast<std::size_t>(bodies[2 * k]));
    order.push_back(static_cast<std::size_t>(at - start.bodies.numbers.begin()));
  }
  for (std::size_t w = 0; w < walls.size(); w += 2) start.walls.push_back({walls[w], walls[w + 1]});
  if (!start.cell) return start;
  start.cell->width = cell[0], start.cell->height = cell[1], start.cell->shift = cell[2];
  start.cell->corner = {cell[3], cell[4]};
  start.strain = {cell[5], cell[6], cell[7]};
  return start;
}

std::size_t StagedSimulation::stages_begun(const SavedState& state) {
  const auto found = std::ranges::find(state.arrays, "stages", &SavedArray::name);
  return found == state.arrays.end() ? 0 : found->values.size() / numbers_per_stage;
}

void StagedSimulation::restore(const SavedState& state) {
  const std::vector<double>&stages = state["stages"], &sums = state["stage_energies"];
  const std::size_t begun = stages_begun(state);
  if (begun < 1 || begun > stages_.size() || sums.size() != 3 ||
      state["stage_walls"].size() != 2 * stages_[begun - 1].scene.walls.size())
    refuse_state(fmt::format("the saved state has begun {}", counted(static_cast<std::int64_t>(begun), "stage")),
                 fmt::format("this run has {} with other walls", stages_.size()));
  const Bonds bonds = bonds_in(state, begun);
  std::vector<BondBreak> past = breaks_of(state["stage_breaks"]);
  if (std::ranges::any_of(past, [&](const BondBreak& event) { return event.bond >= bonds.all.size(); }))
    refuse_state("the saved state has breaks of bonds that are not there", "its file may be damaged");
  std::vector<std::size_t> order;
  Start start = start_in(state, begun, order);
  std::vector<std::int64_t> firsts;
  for (std::size_t k = 0; k < begun; ++k) firsts.push_back(static_cast<std::int64_t>(stages[numbers_per_stage * k]));
  auto simulation = std::make_unique<GrainSimulation>(scene_of(firsts, begun == 1 ? start_of_first() : start, bonds),
                                                      options_, order);
  simulation->restore(state);
  std::vector<StageReport> reports;
  for (std::size_t k = 0; k < begun; ++k) {
    StageReport& report =
        reports.emplace_back(report_of(stages_[k].name, stages.data() + numbers_per_stage * k, simulation->effects()));
    report.added = stages_[k].bodies.added.size();
    report.bonds_made = static_cast<std::size_t>(std::ranges::count(bonds.stages, k));
    report.renamed_walls = stages_[k].renamed_walls;
  }
  take_servos(state["stage_servos"], stages_, reports);
  take_cell_servos(state["stage_cell_servos"], reports);
  take_idle(state["stage_idle"], stages_, reports);
  past_breaks_ = std::move(past);
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
    last.cell_servos.clear();
  }
}

}  // namespace equidem
