// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"

namespace equidem {
namespace {

/// A stage that has begun, its effects as bits in the order of those of the simulation.
struct SavedStage {
  StageReport report;
  double effects = 0;
};

constexpr auto stage_numbers = [](auto& s, const auto& visit) {
  auto& r = s.report;
  visit(r.first), visit(r.last), visit(r.over), visit(r.ended), visit(r.kinetic), visit(r.unbalanced), visit(r.strain);
  visit(r.displacement), visit(r.removed), visit(r.renamed), visit(s.effects);
};

/// A part of the report of a stage.
template <class Report>
struct OfStage {
  std::size_t stage = 0;
  Report report = {};
};

constexpr auto servo_report_numbers = [](auto& s, const auto& visit) {
  auto& r = s.report;
  visit(s.stage), visit(r.touched), visit(r.reached), visit(r.wanted), visit(r.force), visit(r.max_speed);
  visit(r.overshoot), visit(r.peak), visit(r.mean_error);
};

struct SavedCellServo : OfStage<CellServoReport> {
  bool along_y = false;
};
constexpr auto cell_servo_numbers = [](auto& s, const auto& visit) {
  auto& r = s.report;
  visit(s.stage), visit(s.along_y), visit(r.reached), visit(r.wanted), visit(r.stress), visit(r.overshoot);
  visit(r.mean_error);
};

/// A choice of bodies that held none.
struct IdleChoice {
  std::size_t stage = 0;
  bool renames = false;
  std::size_t choice = 0;
};
constexpr auto idle_numbers = [](auto& s, const auto& visit) { visit(s.stage), visit(s.renames), visit(s.choice); };

struct SavedBody {
  std::size_t number = 0;
  int kind = 0;
};
constexpr auto body_numbers = [](auto& s, const auto& visit) { visit(s.number), visit(s.kind); };

constexpr auto place_numbers = [](auto& place, const auto& visit) { visit(place.x), visit(place.y); };

constexpr auto velocity_numbers = [](auto& g, const auto& visit) {
  visit(g.position.x), visit(g.position.y), visit(g.angle), visit(g.velocity.x), visit(g.velocity.y), visit(g.spin);
};

struct MadeBond {
  std::size_t stage = 0;
  GrainBond bond = {};
  double tension = 0, shear = 0;
};
constexpr auto bond_numbers = [](auto& s, const auto& visit) {
  if (!s.bond.rest) s.bond.rest.emplace();
  auto& rest = *s.bond.rest;
  visit(s.stage), visit(s.bond.i), visit(s.bond.j), visit(rest.branch.x), visit(rest.branch.y), visit(rest.angle_i);
  visit(rest.angle_j), visit(s.tension), visit(s.shear);
};

/// \param effects all that there are, in the order of their bits
double bits_of(const std::vector<std::string>& names, const Effects& effects) {
  double bits = 0;
  for (std::size_t k = 0; k < effects.entries.size(); ++k)
    if (std::ranges::find(names, effects.entries[k].name) != names.end()) bits += std::ldexp(1.0, static_cast<int>(k));
  return bits;
}

std::vector<std::string> effects_of_bits(const Effects& effects, double bits) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < effects.entries.size(); ++k)
    if (std::fmod(std::floor(std::ldexp(bits, -static_cast<int>(k))), 2) == 1) names.push_back(effects.entries[k].name);
  return names;
}

[[noreturn]] void refuse_state(const std::string& what, const std::string& why) {
  bad_input(what, why, "Go on with the case that the state was saved from");
}

/// The reports of the stage of a row.
StageReport& report_at(std::vector<StageReport>& reports, std::size_t stage) {
  if (stage < reports.size()) return reports[stage];
  refuse_state(fmt::format("the saved state reports stage {}", stage + 1),
               "it has begun fewer: its file may be damaged");
}

void take_cell_servos(const SavedState& state, std::vector<StageReport>& reports) {
  for (SavedCellServo& saved : rows_in<SavedCellServo>(state, "stage_cell_servos", cell_servo_numbers)) {
    saved.report.component = saved.along_y ? "yy" : "xx";
    report_at(reports, saved.stage).cell_servos.push_back(std::move(saved.report));
  }
}

void take_idle(const SavedState& state, const std::vector<GrainStage>& stages, std::vector<StageReport>& reports) {
  for (const auto& [stage, renames, choice] : rows_in<IdleChoice>(state, "stage_idle", idle_numbers)) {
    StageReport& report = report_at(reports, stage);
    const StageBodies& how = stages[stage].bodies;
    if (choice >= (renames ? how.renamed.size() : how.removed.size()))
      refuse_state(fmt::format("the saved state tells of choices of bodies that stage '{}' does not make", report.name),
                   "its file may be damaged");
    (renames ? report.idle_renamings : report.idle_removals).push_back(choice);
  }
}

/// Reports of servo walls; names are those of the walls of the stage, in their order.
void take_servos(const SavedState& state, const std::vector<GrainStage>& stages, std::vector<StageReport>& reports) {
  for (auto& [stage, saved] : rows_in<OfStage<ServoReport>>(state, "stage_servos", servo_report_numbers)) {
    std::vector<ServoReport>& servos = report_at(reports, stage).servos;
    std::size_t skip = servos.size();
    for (const Wall& wall : stages[stage].scene.walls) {
      if (!wall.servo || skip-- > 0) continue;
      saved.wall = wall.name;
      saved.mirror = wall.servo->mirror;
      servos.push_back(std::move(saved));
      break;
    }
  }
}

}  // namespace

SavedState StagedSimulation::save() const {
  SavedState state = present_->save();
  std::vector<SavedStage> stages;
  std::vector<OfStage<ServoReport>> servos;
  std::vector<SavedCellServo> cell_servos;
  std::vector<IdleChoice> idle;
  for (std::size_t k = 0; k < reports_.size(); ++k) {
    const StageReport& report = reports_[k];
    stages.push_back({report, bits_of(report.effects, present_->effects())});
    for (const ServoReport& servo : report.servos) servos.push_back({k, servo});
    for (const CellServoReport& servo : report.cell_servos)
      cell_servos.push_back({{k, servo}, servo.component == "yy"});
    for (const std::size_t choice : report.idle_removals) idle.push_back({k, false, choice});
    for (const std::size_t choice : report.idle_renamings) idle.push_back({k, true, choice});
  }
  std::vector<double> cell;
  if (start_.cell)
    cell = {start_.cell->width,    start_.cell->height, start_.cell->shift, start_.cell->corner.x,
            start_.cell->corner.y, start_.strain.xx,    start_.strain.yy,   start_.strain.xy};
  std::vector<SavedBody> bodies;
  for (const std::size_t k : present_->order()) bodies.push_back({numbers()[k], start_.bodies.grains[k].kind});
  std::vector<MadeBond> made;
  const std::size_t first = bonds_.all.size() - bonds_.stages.size();
  for (std::size_t k = 0; k < bonds_.stages.size(); ++k) {
    MadeBond& bond = made.emplace_back(MadeBond{bonds_.stages[k], bonds_.all[first + k]});
    if (!bonds_.strengths) continue;
    bond.tension = bonds_.strengths->tension[first + k];
    bond.shear = bonds_.strengths->shear[first + k];
  }
  for (SavedArray& array : std::array{
           saved_rows("stages", std::move(stages), stage_numbers),
           saved_rows("stage_walls", start_.walls, place_numbers),
           saved_rows("stage_cell", std::move(cell), one_number),
           saved_rows("stage_bodies", std::move(bodies), body_numbers),
           saved_rows("stage_motions", number() > 0 ? start_.bodies.grains : std::vector<Grain>{}, velocity_numbers),
           saved_rows("stage_bonds", std::move(made), bond_numbers),
           saved_rows("stage_breaks", past_breaks_, break_numbers),
           saved_rows("stage_servos", std::move(servos), servo_report_numbers),
           saved_rows("stage_cell_servos", std::move(cell_servos), cell_servo_numbers),
           saved_rows("stage_idle", std::move(idle), idle_numbers),
           saved_rows("stage_energies", std::vector{initial_, potential_, changes_}, one_number)})
    state.arrays.push_back(std::move(array));
  return state;
}

StagedSimulation::Bonds StagedSimulation::bonds_in(const SavedState& state, std::size_t begun) const {
  Bonds bonds = bonds_at_start();
  const std::size_t own = stages_.front().scene.bonds.size();
  bonds.all.resize(own);
  bonds.stages.clear();
  if (bonds.strengths) bonds.strengths->tension.resize(own), bonds.strengths->shear.resize(own);
  for (const MadeBond& saved : rows_in<MadeBond>(state, "stage_bonds", bond_numbers)) {
    if (saved.stage >= begun || !stages_[saved.stage].bonds)
      refuse_state(fmt::format("the saved state has bonds made in stage {}", saved.stage), "this run makes none there");
    if (std::max(saved.bond.i, saved.bond.j) >= first_added(saved.stage + 1))
      refuse_state(fmt::format("the saved state has a bond of the bodies {} and {} in stage '{}'", saved.bond.i,
                               saved.bond.j, stages_[saved.stage].name),
                   fmt::format("this run has {} until then", first_added(saved.stage + 1)));
    const StageBonds& how = *stages_[saved.stage].bonds;
    GrainBond& bond = bonds.all.emplace_back(how.like);
    std::tie(bond.i, bond.j, bond.rest) = std::tie(saved.bond.i, saved.bond.j, saved.bond.rest);
    bonds.stages.push_back(saved.stage);
    if (!how.strengths) continue;
    if (!bonds.strengths) bonds.strengths.emplace().friction = how.strengths->friction;
    bonds.strengths->tension.push_back(saved.tension);
    bonds.strengths->shear.push_back(saved.shear);
  }
  return bonds;
}

/// \param[out] order of the bodies in the loops
StagedSimulation::Start StagedSimulation::start_in(const SavedState& state, std::size_t begun,
                                                   std::vector<std::size_t>& order) const {
  const GrainStage& stage = stages_[begun - 1];
  const auto cell = rows_in<double>(state, "stage_cell", one_number);
  const auto motions = rows_in<Grain>(state, "stage_motions", velocity_numbers);
  const auto in_loops = rows_in<SavedBody>(state, "stage_bodies", body_numbers);
  Start start{.walls = rows_in<Vec2>(state, "stage_walls", place_numbers), .bodies = {}, .cell = stage.scene.cell};
  for (const auto& [number, kind] : in_loops) {
    if (number >= first_added(begun))
      refuse_state(fmt::format("the saved state has a body {}", number),
                   fmt::format("this run has {} until then", first_added(begun)));
    if (kind < 0 || kind >= stage.scene.kinds)
      refuse_state(fmt::format("the saved state has a body of kind {}", kind),
                   fmt::format("stage '{}' has {}", stage.name, stage.scene.kinds));
  }
  std::vector<SavedBody> bodies = in_loops;
  std::ranges::sort(bodies, {}, &SavedBody::number);
  if (std::ranges::adjacent_find(bodies, {}, &SavedBody::number) != bodies.end() ||
      motions.size() != (begun > 1 ? bodies.size() : 0) || cell.size() != (start.cell ? 8 : 0))
    refuse_state(fmt::format("the saved state is of {} bodies", bodies.size()), "its parts do not belong together");
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    start.bodies.numbers.push_back(bodies[k].number);
    Grain& grain = start.bodies.grains.emplace_back(body_of_run(bodies[k].number));
    grain.kind = bodies[k].kind;
    if (begun == 1) continue;
    grain.position = motions[k].position, grain.angle = motions[k].angle;
    grain.velocity = motions[k].velocity, grain.spin = motions[k].spin;
  }
  for (const SavedBody& body : in_loops)
    order.push_back(static_cast<std::size_t>(std::ranges::lower_bound(start.bodies.numbers, body.number) -
                                             start.bodies.numbers.begin()));
  if (!start.cell) return start;
  start.cell->width = cell[0], start.cell->height = cell[1], start.cell->shift = cell[2];
  start.cell->corner = {cell[3], cell[4]};
  start.strain = {cell[5], cell[6], cell[7]};
  return start;
}

std::size_t StagedSimulation::stages_begun(const SavedState& state) {
  const auto found = std::ranges::find(state.arrays, "stages", &SavedArray::name);
  return found == state.arrays.end() ? 0 : rows_in<SavedStage>(state, "stages", stage_numbers).size();
}

void StagedSimulation::restore(const SavedState& state) {
  std::vector<SavedStage> stages = rows_in<SavedStage>(state, "stages", stage_numbers);
  const auto sums = rows_in<double>(state, "stage_energies", one_number);
  const std::size_t begun = stages.size();
  if (begun < 1 || begun > stages_.size() || sums.size() != 3 ||
      state["stage_walls"].size() != 2 * stages_[begun - 1].scene.walls.size())
    refuse_state(fmt::format("the saved state has begun {}", counted(static_cast<std::int64_t>(begun), "stage")),
                 fmt::format("this run has {} with other walls", stages_.size()));
  const Bonds bonds = bonds_in(state, begun);
  std::vector<BondBreak> past = rows_in<BondBreak>(state, "stage_breaks", break_numbers);
  if (std::ranges::any_of(past, [&](const BondBreak& event) { return event.bond >= bonds.all.size(); }))
    refuse_state("the saved state has breaks of bonds that are not there", "its file may be damaged");
  std::vector<std::size_t> order;
  Start start = start_in(state, begun, order);
  std::vector<std::int64_t> firsts;
  for (const SavedStage& stage : stages) firsts.push_back(stage.report.first);
  auto simulation = std::make_unique<GrainSimulation>(scene_of(firsts, begun == 1 ? start_of_first() : start, bonds),
                                                      options_, order);
  simulation->restore(state);
  std::vector<StageReport> reports;
  for (std::size_t k = 0; k < begun; ++k) {
    StageReport& report = reports.emplace_back(std::move(stages[k].report));
    report.name = stages_[k].name;
    report.effects = effects_of_bits(simulation->effects(), stages[k].effects);
    report.added = stages_[k].bodies.added.size();
    report.bonds_made = static_cast<std::size_t>(std::ranges::count(bonds.stages, k));
    report.renamed_walls = stages_[k].renamed_walls;
  }
  take_servos(state, stages_, reports);
  take_cell_servos(state, reports);
  take_idle(state, stages_, reports);
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
