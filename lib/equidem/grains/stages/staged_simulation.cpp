// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/staged_simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bonds.hpp"

namespace equidem {
namespace {

constexpr double energy_rounding = 1e-13;  // of sums over all bodies and contacts

/// Steps after which the end of a stage is tested: rest needs all contacts, walls are few.
constexpr std::int64_t steps_between_rests = 256, steps_between_places = 16;

std::int64_t steps_between_tests(const StageEnd& end) {
  if (!end.given()) return std::numeric_limits<std::int64_t>::max();
  return end.at_rest() ? steps_between_rests : steps_between_places;
}

std::size_t index_of(const std::vector<WallState>& walls, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(walls, name, &WallState::name) - walls.begin());
}

/// d_c is that of the first scene in all stages.
GrainOptions with_length(GrainOptions options, const GrainScene& scene) {
  options.reference_length = reference_length(scene, options);
  return options;
}

std::vector<GrainStage> checked(std::vector<GrainStage> stages, const GrainOptions& options) {
  check(stages, options);
  return stages;
}

}  // namespace

StagedSimulation::StagedSimulation(std::vector<GrainStage> stages, const GrainOptions& options)
    : AnySimulation(BodyFamily::colliding, options.time_step),
      stages_(checked(std::move(stages), options)),
      options_(with_length(options, stages_.front().scene)),
      effects_(effects_of(stages_, options_)),
      bonds_(bonds_at_start()),
      present_(scene_of(std::array{StageReport{}}, bodies_at_start(), start_, bonds_), options_) {
  start_.initial = present_.energy().initial;
  reports_.push_back({.name = stages_.front().name,
                      .effects = active_effects(present_.effects()),
                      .bonds_made = bonds_.stages.size()});
  for (const WallState& wall : present_.walls()) start_.walls.push_back(wall.place);
}

void StagedSimulation::advance(std::int64_t steps) {
  if (reports_.back().over && !over()) begin_stage();
  const GrainStage& stage = stages_[number()];
  const std::int64_t first = reports_.back().first, end = first + stage.steps, stride = steps_between_tests(stage.end);
  if (step() == end && !reports_.back().over) refuse_endless();
  while (steps > 0 && !reports_.back().over) {
    const std::int64_t chunk = std::min({steps, end - step(), stride - (step() - first) % stride});
    present_.advance(chunk);
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
  if (done % steps_between_tests(stage.end) != 0 && done != stage.steps) return;
  report.ended = stage.end.given() && holds(stage.end);
  report.over = report.ended || (!stage.end.given() && done == stage.steps);
  if (!report.over) return;
  report.servos = present_.servos();
  if (const auto cell = present_.cell()) report.cell_servos = cell->servos;
}

bool StagedSimulation::holds(const StageEnd& end) {
  StageReport& report = reports_.back();
  const std::vector<WallState> walls = present_.walls();
  bool all = true;
  if (end.displacement > 0) {
    const std::size_t w = index_of(walls, end.wall);
    report.displacement = norm(walls[w].place - start_.walls[w]);
    all = all && report.displacement >= end.displacement;
  }
  if (end.strain > 0 && end.of_cell) {
    constexpr double Voigt::*components[] = {&Voigt::xx, &Voigt::yy, &Voigt::xy};  // of StageEnd::CellStrain
    const auto which = components[static_cast<std::size_t>(*end.of_cell)];
    report.strain = std::abs(present_.cell()->strain.*which - start_.strain.*which);
    all = all && report.strain >= end.strain;
  } else if (end.strain > 0) {
    const std::size_t a = index_of(walls, end.walls[0]), b = index_of(walls, end.walls[1]);
    const Vec2 across = present_.placed_walls()[a].normal;  // points on lines may lie anywhere along them
    const double before = dot(start_.walls[b] - start_.walls[a], across),
                 now = dot(walls[b].place - walls[a].place, across);
    report.strain = std::abs(now / before - 1);
    all = all && report.strain >= end.strain;
  }
  if (!end.at_rest() || !all) return all;
  const EnergyLedger energy = present_.energy();
  report.kinetic = energy.elastic() > 0 ? energy.kinetic / energy.elastic() : StageEnd::infinite;
  report.unbalanced = unbalance_of(present_, holding_bonds().bonds, stages_[number()].scene.gravity).mean;
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

StagedSimulation::HoldingBonds StagedSimulation::holding_bonds() const {
  const std::vector<Grain> bodies = present_.grains();
  std::vector<char> broken(bonds_.all.size(), 0);
  for (const BondBreak& event : present_.breaks()) broken[event.bond] = 1;
  HoldingBonds holding;
  for (std::size_t b = 0; b < broken.size(); ++b) {
    const GrainBond& bond = bonds_.all[b];
    if (broken[b] != 0 || !bodies[bond.i].present || !bodies[bond.j].present) continue;
    holding.bonds.push_back(bond);
    if (!bonds_.strengths) continue;
    holding.strengths.tension.push_back(bonds_.strengths->tension[b]);
    holding.strengths.shear.push_back(bonds_.strengths->shear[b]);
  }
  return holding;
}

std::int64_t StagedSimulation::milestone() const {
  return reports_.back().over ? step() : -1;
}

bool StagedSimulation::over() const {
  return reports_.size() == stages_.size() && reports_.back().over;
}

EnergyLedger StagedSimulation::energy() const {
  EnergyLedger ledger = present_.energy();
  ledger.initial = start_.initial;
  ledger.potential += start_.potential;
  ledger.work_of_stages = start_.changes;
  return ledger;
}

// How a stage begins.

/// All bodies of the run, those present that are in the first scene.
std::vector<Grain> StagedSimulation::bodies_at_start() const {
  std::vector<Grain> bodies = stages_.front().scene.grains;
  for (const GrainStage& stage : stages_)
    for (const Grain& grain : stage.bodies.added) bodies.emplace_back(grain).present = false;
  return bodies;
}

StagedSimulation::Bonds StagedSimulation::bonds_at_start() const {
  const GrainScene& scene = stages_.front().scene;
  Bonds bonds{scene.bonds, scene.strengths, {}};
  for (GrainBond& bond : bonds.all)
    if (!bond.rest) bond.rest = rest_of(scene, bond.i, bond.j);
  return bonds_of(0, std::move(bonds), scene.grains, scene.cell, {});
}

StagedSimulation::Bonds StagedSimulation::bonds_of(std::size_t stage, Bonds bonds, const std::vector<Grain>& bodies,
                                                   const std::optional<PeriodicCell>& cell,
                                                   std::span<const GrainContact> contacts) const {
  if (!stages_[stage].bonds) return bonds;
  const StageBonds& how = *stages_[stage].bonds;
  GrainScene scene;
  scene.grains = bodies;
  scene.cell = cell;
  scene.bonds = bonds.all;
  scene.bonds = make_bonds(scene, contacts, how);
  if (how.strengths) {
    const ContactStrengths made = bond_strengths(scene, *how.strengths);
    if (!bonds.strengths) bonds.strengths = ContactStrengths{{}, {}, made.friction, made.beside_contact};
    bonds.strengths->tension.insert(bonds.strengths->tension.end(), made.tension.begin(), made.tension.end());
    bonds.strengths->shear.insert(bonds.strengths->shear.end(), made.shear.begin(), made.shear.end());
  }
  bonds.all.insert(bonds.all.end(), scene.bonds.begin(), scene.bonds.end());
  bonds.stages.insert(bonds.stages.end(), scene.bonds.size(), stage);
  return bonds;
}

std::size_t StagedSimulation::first_added(std::size_t stage) const {
  std::size_t number = stages_.front().scene.grains.size();
  for (std::size_t k = 0; k < stage; ++k) number += stages_[k].bodies.added.size();
  return number;
}

/// The stage that gave the servo of a wall its schedule.
std::size_t StagedSimulation::stage_of_servo(std::size_t stage, std::size_t wall) const {
  for (; stage > 0 && stages_[stage].scene.walls[wall].servo->goes_on; --stage) {
    const std::int32_t before = wall_origins(stages_[stage], stages_[stage - 1])[wall];
    if (before < 0) break;
    wall = static_cast<std::size_t>(before);
  }
  return stage;
}

/// Likewise of a stress of the cell.
std::size_t StagedSimulation::stage_of_stress(std::size_t stage, bool CellServo::*goes_on) const {
  while (stage > 0 && (*stages_[stage].scene.cell->servo).*goes_on) --stage;
  return stage;
}

/// The scene of a stage.
/// \param reports of the stages up to this one, of which their first steps are read
GrainScene StagedSimulation::scene_of(std::span<const StageReport> reports, std::vector<Grain> bodies,
                                      const Start& start, const Bonds& bonds) const {
  const std::size_t stage = reports.size() - 1;
  const auto time_of = [&](std::size_t k) { return static_cast<double>(reports[k].first) * options_.time_step; };
  GrainScene scene = stages_[stage].scene;
  scene.grains = std::move(bodies);
  scene.bonds = bonds.all;
  scene.strengths = bonds.strengths;
  const double time = time_of(stage);
  for (std::size_t w = 0; stage > 0 && w < start.walls.size(); ++w) {
    Wall& wall = scene.walls[w];
    wall.end += start.walls[w] - wall.point;
    wall.point = start.walls[w];
    wall.move_x = delayed(wall.move_x, time);
    wall.move_y = delayed(wall.move_y, time);
    if (wall.servo) wall.servo->wanted = delayed(wall.servo->wanted, time_of(stage_of_servo(stage, w)));
  }
  if (!scene.cell) return scene;
  PeriodicCell& cell = *scene.cell;
  for (Schedule* rate : {&cell.rate_xx, &cell.rate_yy, &cell.rate_xy}) *rate = delayed(*rate, time);
  if (cell.servo)
    for (const auto& [stress, goes_on] : {std::pair{&cell.servo->stress_xx, &CellServo::goes_on_xx},
                                          std::pair{&cell.servo->stress_yy, &CellServo::goes_on_yy}})
      if (*stress) *stress = delayed(**stress, time_of(stage_of_stress(stage, goes_on)));
  return scene;
}

void StagedSimulation::begin_stage() {
  const EnergyLedger before = energy();
  const std::size_t next = number() + 1;
  const GrainStage& stage = stages_[next];
  Start start{.walls = {}, .initial = start_.initial, .potential = before.potential, .changes = start_.changes};
  if (const auto cell = present_.cell()) start.strain = cell->strain;
  const std::vector<std::int32_t> origins = wall_origins(stage, stages_[number()]);
  const std::vector<WallState> standing = present_.walls();
  for (std::size_t w = 0; w < origins.size(); ++w)
    start.walls.push_back(origins[w] < 0 ? stage.scene.walls[w].point : standing[origins[w]].place);
  std::vector<StageReport> reports = reports_;
  StageReport& report = reports.emplace_back();
  report.name = stage.name;
  report.first = report.last = step();
  report.renamed_walls = stage.renamed_walls;
  report.added = stage.bodies.added.size();
  Bonds bonds;
  try {
    std::vector<Grain> bodies = present_.grains();
    change_bodies(bodies, stage.bodies, first_added(next), report);
    bonds = bonds_of(next, bonds_, bodies, present_.placed_cell(), present_.contacts());
    present_.change(scene_of(reports, std::move(bodies), start, bonds), origins);
  } catch (const Error& error) {
    throw error.at(stage.where());
  }
  report.effects = active_effects(present_.effects());
  report.bonds_made = bonds.all.size() - bonds_.all.size();
  reports_ = std::move(reports);
  start_ = std::move(start);
  bonds_ = std::move(bonds);
  const EnergyLedger after = present_.energy();
  const double stored = before.kinetic + before.elastic();
  const double change = after.kinetic + after.elastic() - stored + (after.cohesion - before.cohesion);
  if (std::abs(change) > energy_rounding * stored) start_.changes += change;
}

// Saved states.

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

/// A servo in the report of a stage that is over; those of a stage are in the order of its walls, then of its cell.
struct SavedServo {
  std::size_t stage = 0;
  bool of_cell = false, along_y = false;
  ServoReport report = {};
};
constexpr auto servo_report_numbers = [](auto& s, const auto& visit) {
  auto& r = s.report;
  visit(s.stage), visit(s.of_cell), visit(s.along_y), visit(r.touched), visit(r.max_speed), visit(r.reached);
  visit(r.wanted), visit(r.present), visit(r.overshoot), visit(r.peak), visit(r.mean_error);
};

/// A choice of bodies that held none.
struct IdleChoice {
  std::size_t stage = 0;
  bool renames = false;
  std::size_t choice = 0;
};
constexpr auto idle_numbers = [](auto& s, const auto& visit) { visit(s.stage), visit(s.renames), visit(s.choice); };

constexpr auto body_numbers = [](auto& grain, const auto& visit) { visit(grain.present), visit(grain.kind); };
/// But for the walls.
constexpr auto stage_start_numbers = [](auto& start, const auto& visit) {
  visit(start.initial), visit(start.potential), visit(start.changes);
  visit(start.strain.xx), visit(start.strain.yy), visit(start.strain.xy);
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

void take_servos(const SavedState& state, const std::vector<GrainStage>& stages, std::vector<StageReport>& reports) {
  for (SavedServo& saved : rows_in<SavedServo>(state, "stage_servos", servo_report_numbers)) {
    StageReport& report = report_at(reports, saved.stage);
    if (saved.of_cell) {
      report.cell_servos.push_back({saved.report, saved.along_y ? "yy" : "xx"});
      continue;
    }
    std::size_t skip = report.servos.size();
    for (const Wall& wall : stages[saved.stage].scene.walls) {
      if (!wall.servo || skip-- > 0) continue;
      saved.report.wall = wall.name;
      saved.report.mirror = wall.servo->mirror;
      report.servos.push_back(std::move(saved.report));
      break;
    }
  }
}

}  // namespace

SavedState StagedSimulation::save() const {
  SavedState state = present_.save();
  std::vector<SavedStage> stages;
  std::vector<SavedServo> servos;
  std::vector<IdleChoice> idle;
  for (std::size_t k = 0; k < reports_.size(); ++k) {
    const StageReport& report = reports_[k];
    stages.push_back({report, bits_of(report.effects, effects_)});
    for (const ServoReport& servo : report.servos) servos.push_back({k, false, false, servo});
    for (const CellServoReport& servo : report.cell_servos)
      servos.push_back({k, true, servo.component == "yy", ServoReport{servo}});
    for (const std::size_t choice : report.idle_removals) idle.push_back({k, false, choice});
    for (const std::size_t choice : report.idle_renamings) idle.push_back({k, true, choice});
  }
  std::vector<Grain> bodies = present_.grains();
  bodies.resize(first_added(reports_.size()));  // those of later stages may still change
  std::vector<MadeBond> made;
  const std::size_t first = bonds_.all.size() - bonds_.stages.size();
  for (std::size_t k = 0; k < bonds_.stages.size(); ++k) {
    MadeBond& bond = made.emplace_back(MadeBond{bonds_.stages[k], bonds_.all[first + k]});
    if (!bonds_.strengths) continue;
    bond.tension = bonds_.strengths->tension[first + k];
    bond.shear = bonds_.strengths->shear[first + k];
  }
  for (SavedArray& array : std::array{saved_rows("stages", std::move(stages), stage_numbers),
                                      saved_rows("stage_walls", start_.walls, vector_numbers),
                                      saved_rows("stage_start", std::vector{start_}, stage_start_numbers),
                                      saved_rows("stage_bodies", std::move(bodies), body_numbers),
                                      saved_rows("stage_bonds", std::move(made), bond_numbers),
                                      saved_rows("stage_servos", std::move(servos), servo_report_numbers),
                                      saved_rows("stage_idle", std::move(idle), idle_numbers)})
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
    if (!bonds.strengths)
      bonds.strengths =
          ContactStrengths{{}, {}, how.strengths->friction, how.strengths->after_breaking == AfterBreaking::parallel};
    bonds.strengths->tension.push_back(saved.tension);
    bonds.strengths->shear.push_back(saved.shear);
  }
  return bonds;
}

std::vector<Grain> StagedSimulation::bodies_in(const SavedState& state, std::size_t begun) const {
  const GrainStage& stage = stages_[begun - 1];
  const auto saved = rows_in<Grain>(state, "stage_bodies", body_numbers);
  if (saved.size() != first_added(begun) || std::ranges::none_of(saved, &Grain::present))
    refuse_state(
        fmt::format("the saved state has {}", counted(std::ssize(saved), "body", "bodies")),
        fmt::format("until the stage '{}' this run has {}, and one must be there", stage.name, first_added(begun)));
  std::vector<Grain> bodies = bodies_at_start();
  for (std::size_t k = 0; k < saved.size(); ++k) {
    const int kind = saved[k].kind;
    if (saved[k].present && (kind < 0 || kind >= stage.scene.kinds))
      refuse_state(fmt::format("the saved state has a body of kind {}", kind),
                   fmt::format("the stage '{}' has {}", stage.name, counted(stage.scene.kinds, "kind")));
    bodies[k].present = saved[k].present, bodies[k].kind = kind;
  }
  return bodies;
}

std::size_t StagedSimulation::stages_begun(const SavedState& state) {
  const auto found = std::ranges::find(state.arrays, "stages", &SavedArray::name);
  return found == state.arrays.end() ? 0 : rows_in<SavedStage>(state, "stages", stage_numbers).size();
}

void StagedSimulation::restore(const SavedState& state) {
  std::vector<SavedStage> stages = rows_in<SavedStage>(state, "stages", stage_numbers);
  auto starts = rows_in<Start>(state, "stage_start", stage_start_numbers);
  const std::size_t begun = stages.size();
  if (begun < 1 || begun > stages_.size() || starts.size() != 1 ||
      state["stage_walls"].size() != 2 * stages_[begun - 1].scene.walls.size())
    refuse_state(fmt::format("the saved state has begun {}", counted(static_cast<std::int64_t>(begun), "stage")),
                 fmt::format("this run has {} with other walls", stages_.size()));
  Bonds bonds = bonds_in(state, begun);
  starts[0].walls = rows_in<Vec2>(state, "stage_walls", vector_numbers);
  std::vector<StageReport> reports;
  for (std::size_t k = 0; k < begun; ++k) {
    StageReport& report = reports.emplace_back(std::move(stages[k].report));
    report.name = stages_[k].name;
    report.effects = effects_of_bits(effects_, stages[k].effects);
    report.added = stages_[k].bodies.added.size();
    report.bonds_made = static_cast<std::size_t>(std::ranges::count(bonds.stages, k));
    report.renamed_walls = stages_[k].renamed_walls;
  }
  take_servos(state, stages_, reports);
  take_idle(state, stages_, reports);
  present_.restore(scene_of(reports, bodies_in(state, begun), starts[0], bonds), state);
  reports_ = std::move(reports);
  start_ = std::move(starts[0]);
  bonds_ = std::move(bonds);
  // a length or limit that was raised after the stage had reached it
  StageReport& last = reports_.back();
  if (last.over && !last.ended && last.last < last.first + stages_[begun - 1].steps) {
    last.over = false;
    last.servos.clear();
    last.cell_servos.clear();
  }
}

}  // namespace equidem
