// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What a simulation goes on from: kept for a step that fails, handed on to the next stage, saved in files.
#include <algorithm>
#include <limits>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {
namespace {

constexpr const char* go_on_with = "Resume with the scene that the state was saved from";

// The numbers of rows of a saved state.

constexpr auto grain_numbers = [](auto& m, const auto& visit) {
  visit(m.position.x), visit(m.position.y), visit(m.velocity.x), visit(m.velocity.y), visit(m.spin), visit(m.angle);
};

/// Images in periodic cells, parts and arms in scenes with shapes.
auto numbers_of_contact(const GrainSystem& system) {
  return [cell = system.cell.active, shapes = !system.shapes.parts.empty(), rolling = system.rolling](
             auto& c, const auto& visit) {
    visit(c.i), visit(c.j), visit(c.steps), visit(c.mode), visit(c.parted), visit(c.overlap), visit(c.closing);
    visit(c.normal.x), visit(c.normal.y), visit(c.impulse), visit(c.moment), visit(c.tangential_impulse);
    visit(c.stretch);
    if (cell) visit(c.a), visit(c.b);
    if (rolling) visit(c.rolling_stretch), visit(c.rolling_impulse);
    if (!shapes) return;
    visit(c.part_i), visit(c.part_j), visit(c.arm_i.x), visit(c.arm_i.y), visit(c.arm_j.x), visit(c.arm_j.y);
  };
}

constexpr auto impulse_numbers = [](auto& push, const auto& visit) {
  visit(push.impulse.x), visit(push.impulse.y), visit(push.torque);
};

static_assert(sizeof(GrainCounters) == 5 * sizeof(std::int64_t), "a counter is not saved");
constexpr auto counter_numbers = [](auto& c, const auto& visit) {
  visit(c.evaluations), visit(c.contacts), visit(c.rebuilds), visit(c.sweeps), visit(c.doubtful);
};

constexpr auto load_numbers = [](auto& load, const auto& visit) {
  visit(load.impulse.x), visit(load.impulse.y), visit(load.step_impulse.x), visit(load.step_impulse.y);
  visit(load.step_angular), visit(load.work);
};

constexpr auto servo_numbers = [](auto& s, const auto& visit) {
  control_numbers(s, visit);
  visit(s.way), visit(s.passed_speed), visit(s.free_way), visit(s.touched), visit(s.farthest);
};

constexpr auto cell_numbers = [](auto& cell, const auto& visit) {
  for (auto* periods : {&cell.now, &cell.before})
    for (auto* vector : {&periods->a, &periods->b}) visit(vector->x), visit(vector->y);
  for (auto* tensor : {&cell.gradient, &cell.moment, &cell.stress})
    visit(tensor->xx), visit(tensor->xy), visit(tensor->yx), visit(tensor->yy);
  visit(cell.strain.xx), visit(cell.strain.yy), visit(cell.strain.xy);
  for (auto& control : cell.controls)
    control_numbers(control, visit), visit(control.stiffness), visit(control.viscosity);
};

constexpr auto start_numbers = [](auto& start, const auto& visit) { visit(start.potential), visit(start.energy); };

constexpr auto image_numbers = [](auto& image, const auto& visit) { visit(image.a), visit(image.b); };

/// Whether the contacts of a saved state are between bodies, walls and parts of the scene.
bool are_of_scene(const GrainSystem& system, const std::vector<ContactState>& contacts) {
  const auto bodies = std::ssize(system.bodies.constants), walls = std::ssize(system.walls.loads);
  const auto parts = std::max<std::ptrdiff_t>(1, std::ssize(system.shapes.body_of_part));
  return std::ranges::all_of(contacts, [&](const ContactState& c) {
    const bool part = c.part_i >= 0 && c.part_i < parts && c.part_j >= 0 && c.part_j < parts;
    return part && c.i >= 0 && c.i < bodies && c.j < bodies && (c.j >= 0 || ~c.j < walls);
  });
}

}  // namespace

namespace {

/// Call visit(member of the state, member of the candidate) for all that a contact by a map carries from step to step.
template <class State, class Contact, class Visit>
void each_member(State& state, Contact& candidate, const Visit& visit) {
  visit(state.parted, candidate.parted), visit(state.mode, candidate.mode), visit(state.steps, candidate.steps);
  visit(state.overlap, candidate.overlap), visit(state.closing, candidate.closing);
  visit(state.normal, candidate.normal), visit(state.impulse, candidate.impulse);
  visit(state.moment, candidate.moment), visit(state.tangential_impulse, candidate.tangential_impulse);
  visit(state.stretch, candidate.stretch);
}

/// The lever at a wall is the radius; those of two discs add up to the distance of their centres.
ContactState state_of(const GrainSystem& system, const Candidate& candidate) {
  const double radius = system.bodies.constants[candidate.i].radius;
  ContactState state;
  static_cast<Partners&>(state) = {candidate.i, candidate.j};
  each_member(state, candidate, [](auto& of_state, const auto& own) { of_state = own; });
  state.arm_i = radius * candidate.normal;
  if (candidate.j < 0) return state;
  const double sum = radius + system.bodies.constants[candidate.j].radius;
  const double distance = sum - candidate.overlap, lever = radius / sum * distance;
  state.arm_i = lever * candidate.normal;
  state.arm_j = (lever - distance) * candidate.normal;
  return state;
}

}  // namespace

std::vector<ContactState> contact_states(const GrainSystem& system) {
  std::vector<ContactState> states;
  std::size_t most = system.contacts.candidates.size();
  each_list(system.contacts, [&](const NearList& list) { most += list.count; });
  states.reserve(most);
  each_list(system.contacts, [&](const NearList& list) {
    for (std::size_t p = 0; p < list.count; ++p)
      if (list.touching(p)) states.push_back(state_of(system, list, p));
  });
  for (const Candidate& candidate : system.contacts.candidates)
    if (candidate.touching) states.push_back(state_of(system, candidate));
  return states;
}

GrainState GrainSimulation::Implementation::state() const {
  GrainState state{.step = system.step,
                   .motions = system.bodies.motions,
                   .contacts = contact_states(system),
                   .impulses = {},
                   .bonds = {},
                   .breaks = {},
                   .lost = system.lost,
                   .counters = system.counters,
                   .walls = system.walls.loads,
                   .servos = {system.walls.servos.begin(), system.walls.servos.end()},
                   .start = at_start,
                   .cell = system.cell,
                   .crossed = system.cell.crossed};
  if (keeps_impulses()) state.impulses = system.bodies.impulses;  // the others find all of a step in that step
  for (const TiedPair& bond : system.bonds.tied) state.bonds.push_back(state_of(system, bond));
  state.breaks = system.bonds.breaks;
  return state;
}

SavedState GrainSimulation::save() const {
  const GrainSystem& system = implementation_->system;
  GrainState state = implementation_->state();
  SavedState saved{.step = state.step,
                   .arrays = {saved_rows("motions", std::move(state.motions), grain_numbers),
                              saved_rows("contacts", std::move(state.contacts), numbers_of_contact(system)),
                              saved_rows("impulses", std::move(state.impulses), impulse_numbers),
                              saved_rows("bonds", std::move(state.bonds), bond_numbers_of_state),
                              saved_rows("breaks", std::move(state.breaks), break_numbers),
                              saved_rows("losses", std::vector{state.lost}, ledger_numbers(family())),
                              saved_rows("counters", std::vector{state.counters}, counter_numbers),
                              saved_rows("walls", std::move(state.walls), load_numbers),
                              saved_rows("servos", std::move(state.servos), servo_numbers),
                              saved_rows("start", std::vector{state.start}, start_numbers)}};
  if (!system.cell.active) return saved;
  saved.arrays.push_back(saved_rows("cell", std::vector{state.cell}, cell_numbers));
  saved.arrays.push_back(saved_rows("crossed", std::move(state.crossed), image_numbers));
  return saved;
}

void GrainSimulation::restore(const SavedState& saved) {
  implementation_->restore(saved);
}

void GrainSimulation::Implementation::restore(const SavedState& saved) {
  const auto losses = rows_in<EnergyLedger>(saved, "losses", ledger_numbers(BodyFamily::colliding));
  const auto counters = rows_in<GrainCounters>(saved, "counters", counter_numbers);
  const auto start = rows_in<EnergyAtStart>(saved, "start", start_numbers);
  GrainState state{.step = saved.step,
                   .motions = rows_in<GrainMotion>(saved, "motions", grain_numbers),
                   .contacts = rows_in<ContactState>(saved, "contacts", numbers_of_contact(system)),
                   .impulses = rows_in<BodyImpulse>(saved, "impulses", impulse_numbers),
                   .bonds = rows_in<BondState>(saved, "bonds", bond_numbers_of_state),
                   .breaks = rows_in<BondBreak>(saved, "breaks", break_numbers),
                   .walls = rows_in<WallLoad>(saved, "walls", load_numbers),
                   .servos = rows_in<ServoMotion>(saved, "servos", servo_numbers)};
  check_breaks(system, state.breaks);
  const std::size_t bodies = system.bodies.motions.size();
  if (state.motions.size() != bodies || !are_of_scene(system, state.contacts) ||
      state.impulses.size() != (keeps_impulses() ? bodies : 0) || state.bonds.size() != system.bonds.tied.size() ||
      losses.size() != 1 || counters.size() != 1 || state.walls.size() != system.walls.loads.size() ||
      state.servos.size() != system.walls.servos.size() || start.size() != 1) {
    bad_input(fmt::format("the state is of {}", counted(std::ssize(state.motions), "grain")),
              fmt::format("the scene has {}", bodies), go_on_with);
  }
  state.lost = losses[0];
  state.counters = counters[0];
  state.start = start[0];
  if (system.cell.active) {
    const auto cells = rows_in<CellMotion>(saved, "cell", cell_numbers);
    state.crossed = rows_in<PeriodicImage>(saved, "crossed", image_numbers);
    if (cells.size() != 1 || state.crossed.size() != bodies)
      bad_input("the state is of another periodic cell", "it has other numbers than this one", go_on_with);
    state.cell = cells[0];
  }
  go_back_to(state);
  kept.reset();
}

std::vector<BondBreak> GrainSimulation::breaks() const {
  return implementation_->system.bonds.breaks;
}

void GrainSimulation::stop_all() {
  GrainState state = implementation_->state();
  state.lost.lost_dashpot += implementation_->potential_and_kinetic().second;
  for (GrainMotion& motion : state.motions) motion.velocity = {}, motion.spin = 0;
  implementation_->go_back_to(state);
  implementation_->kept.reset();
}

void GrainSimulation::Implementation::go_back_to(const GrainState& state) {
  system.step = state.step;
  at_start = state.start;
  if (system.cell.active) {
    static_cast<CellMotion&>(system.cell) = state.cell;
    system.cell.next = system.cell.now;
    system.cell.crossed = state.crossed;
  }
  system.lost = state.lost;
  system.bodies.motions = state.motions;
  if (!state.impulses.empty()) system.bodies.impulses = state.impulses;
  system.bodies.at_zero = false;
  restore_breaks(system, state.breaks);
  take_states(system, state.bonds);
  system.walls.loads = state.walls;
  for (std::size_t s = 0; s < state.servos.size(); ++s)
    static_cast<ServoMotion&>(system.walls.servos[s]) = state.servos[s];
  system.deepest = std::numeric_limits<double>::infinity();  // not known: verlet has to look
  place_walls(system);
  turn_axes(system);
  system.contacts.candidates.clear();
  system.contacts.exact_pairs.clear();
  if (system.contacts.has(Between::discs)) load_pair_bodies(system);
  const auto is_far = [&](const ContactState& c) {
    const std::vector<GrainBody>& bodies = system.bodies.constants;
    return c.j >= 0 && norm(system.branch(c)) > 2 * (bodies[c.i].radius + bodies[c.j].radius) + system.range;
  };
  if (system.cell.active && std::ranges::any_of(state.contacts, is_far))
    bad_input("the state has a contact with an image that is far away", "it is of another scene, or damaged",
              go_on_with);
  take_contacts(system, state.contacts);
  find_candidates(system);
  if (!gives_force(system.options.law)) {
    auto candidate = system.contacts.candidates.begin();
    const auto end = system.contacts.candidates.end();
    for (const ContactState& contact : state.contacts) {
      while (candidate != end && (candidate->i != contact.i || candidate->j != contact.j)) ++candidate;
      if (candidate == end)
        bad_input("the state has a contact of bodies that are apart", "it is of another scene, or damaged", go_on_with);
      candidate->touching = true;
      each_member(contact, *candidate, [](const auto& of_state, auto& own) { own = of_state; });
    }
  }
  system.counters = state.counters;
}

}  // namespace equidem
