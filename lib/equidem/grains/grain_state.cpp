// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/contacts/bond_step.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"
#include "equidem/grains/neighbours/part_pairs.hpp"

namespace equidem {
namespace {

constexpr std::size_t numbers_per_image = 2;
constexpr std::size_t numbers_per_impulse = 3;
constexpr std::size_t numbers_per_bond = 3;

constexpr std::size_t numbers_per_wall = 6;
constexpr double ServoState::*servo_saved[] = {
    &ServoState::way,     &ServoState::speed,  &ServoState::passed_speed,   &ServoState::free_way,
    &ServoState::wanted,  &ServoState::force,  &ServoState::largest_wanted, &ServoState::overshoot,
    &ServoState::pace,    &ServoState::errors, &ServoState::steps,          &ServoState::touched,
    &ServoState::reached, &ServoState::side,   &ServoState::excess,         &ServoState::peak,
    &ServoState::arrived};

constexpr std::int64_t GrainCounters::*counters_saved[] = {&GrainCounters::evaluations, &GrainCounters::contacts,
                                                           &GrainCounters::rebuilds, &GrainCounters::sweeps,
                                                           &GrainCounters::doubtful};
static_assert(sizeof(GrainCounters) == std::size(counters_saved) * sizeof(std::int64_t), "a counter is not saved");

void append(std::vector<double>& numbers, const PartPair& pair) {
  for (const double number : {static_cast<double>(pair.i), static_cast<double>(pair.j), pair.arm_i.x, pair.arm_i.y,
                              pair.arm_j.x, pair.arm_j.y}) {
    numbers.push_back(number);
  }
}

void append(std::vector<double>& numbers, const PeriodicImage& image) {
  numbers.push_back(image.a);
  numbers.push_back(image.b);
}

PartPair pair_of(const double* numbers) {
  PartPair pair;
  pair.i = static_cast<std::int32_t>(numbers[0]);
  pair.j = static_cast<std::int32_t>(numbers[1]);
  pair.arm_i = {numbers[2], numbers[3]};
  pair.arm_j = {numbers[4], numbers[5]};
  return pair;
}

bool is_of(const double* numbers, const PartPair& pair) {
  return numbers[0] == static_cast<double>(pair.i) && numbers[1] == static_cast<double>(pair.j);
}

PeriodicImage image_of(const double* numbers, std::int32_t body) {
  return {body, static_cast<std::int32_t>(numbers[1]), static_cast<std::int32_t>(numbers[0])};
}

void append(std::vector<double>& numbers, const Candidate& candidate) {
  numbers.insert(numbers.end(),
                 {static_cast<double>(candidate.i), static_cast<double>(candidate.j),
                  static_cast<double>(candidate.steps), static_cast<double>(candidate.mode), candidate.stretch,
                  candidate.overlap, candidate.closing, candidate.normal.x, candidate.normal.y, candidate.impulse,
                  candidate.moment, candidate.tangential_impulse, candidate.parted ? 1.0 : 0.0});
}

void take(const double* numbers, Candidate& candidate) {
  using At = ContactColumns;
  candidate.i = static_cast<std::int32_t>(numbers[At::i]);
  candidate.j = static_cast<std::int32_t>(numbers[At::j]);
  candidate.steps = static_cast<std::int64_t>(numbers[At::steps]);
  candidate.mode = static_cast<int>(numbers[At::mode]);
  candidate.stretch = numbers[At::stretch];
  candidate.overlap = numbers[At::overlap];
  candidate.closing = numbers[At::closing];
  candidate.normal = {numbers[At::normal], numbers[At::normal + 1]};
  candidate.impulse = numbers[At::impulse];
  candidate.moment = numbers[At::moment];
  candidate.tangential_impulse = numbers[At::tangential_impulse];
  candidate.parted = numbers[At::parted] != 0;
  candidate.touching = true;
}

}  // namespace

SavedState GrainSimulation::save() const {
  const GrainSystem& system = implementation_->system;
  std::vector<double> contacts, losses, counts, impulses, bonds, walls, servos;
  std::size_t listed = system.contacts.candidates.size();
  for (const PairBlock& block : system.contacts.near.blocks) listed += block.count;
  each_list_of_parts(system.contacts.near_parts, [&](const NearParts::List& list) { listed += list.count; });
  contacts.reserve(listed * ContactColumns(system).count);
  const auto append_imaged = [&](Candidate candidate, PartPair pair) {
    const PeriodicImage image = system.is_image(candidate.j) ? system.image(candidate.j) : PeriodicImage{candidate.j};
    candidate.j = image.body;
    append(contacts, candidate);
    if (system.cell.active) append(contacts, image);
    if (system.shapes.parts.empty()) return;
    pair.j = system.own_part(pair.j);
    append(contacts, pair);
  };
  for (const PairBlock& block : system.contacts.near.blocks)
    for (std::size_t p = 0; p < block.count; ++p)
      if (block.touching(p))
        append_imaged(candidate_of(system, block, p), parts_of_discs(system, block.first(p), block.second(p)));
  each_list_of_parts(system.contacts.near_parts, [&](const NearParts::List& list) {
    for (std::size_t p = 0; p < list.count; ++p) {
      if (!list.touching(p)) continue;
      const auto [candidate, pair] = candidate_of(system, list, p);
      append_imaged(candidate, pair);
    }
  });
  for (std::size_t c = 0; c < system.contacts.candidates.size(); ++c) {
    if (!system.contacts.candidates[c].touching) continue;
    append(contacts, system.contacts.candidates[c]);
    if (system.cell.active) append(contacts, PeriodicImage{});
    if (!system.shapes.parts.empty()) append(contacts, system.contacts.part_pairs[c]);
  }
  for (const EnergyTerm& term : energy_terms(BodyFamily::colliding)) losses.push_back(system.lost.*term.value);
  for (const auto counter : counters_saved) counts.push_back(static_cast<double>(system.counters.*counter));
  if (implementation_->keeps_impulses()) {  // the others find all impulses of a step in that step
    impulses.reserve(numbers_per_impulse * system.bodies.impulses.size());
    for (const BodyImpulse& push : system.bodies.impulses)
      impulses.insert(impulses.end(), {push.impulse.x, push.impulse.y, push.torque});
  }
  for (const TiedPair& bond : system.bonds.tied) {
    const BondModes impulse = last_impulse(system, bond);
    bonds.insert(bonds.end(), {impulse.normal, impulse.tangential, impulse.rolling});
  }
  for (const WallLoad& load : system.walls.loads)
    walls.insert(walls.end(), {load.impulse.x, load.impulse.y, load.step_impulse.x, load.step_impulse.y,
                               load.step_angular, load.work});
  for (const ServoState& servo : system.walls.servos)
    for (const auto number : servo_saved) servos.push_back(servo.*number);
  SavedState state{.step = system.step,
                   .arrays = {{"motions", 3, numbers_of(motions())},
                              {"velocities", 3, numbers_of(velocities())},
                              {"contacts", ContactColumns(system).count, std::move(contacts)},
                              {"impulses", numbers_per_impulse, std::move(impulses)},
                              {"bonds", numbers_per_bond, std::move(bonds)},
                              {"losses", 1, std::move(losses)},
                              {"counters", 1, std::move(counts)},
                              {"walls", numbers_per_wall, std::move(walls)},
                              {"servos", std::size(servo_saved), std::move(servos)},
                              {"start", 1, {implementation_->potential_at_start, implementation_->energy_at_start}}}};
  if (const auto& breakable = system.bonds.breakable)
    state.arrays.push_back({"breaks", numbers_per_break, numbers_of(breakable->breaks)});
  if (system.cell.active) {
    std::vector<double> crossed;
    for (const std::int32_t place : system.bodies.place_of_grain)
      append(crossed, system.cell.crossed[static_cast<std::size_t>(place)]);
    state.arrays.push_back({"cell", 1, numbers_of_cell(system.cell)});
    state.arrays.push_back({"crossed", numbers_per_image, std::move(crossed)});
  }
  return state;
}

std::vector<BondBreak> GrainSimulation::breaks() const {
  const auto& breakable = implementation_->system.bonds.breakable;
  return breakable ? breakable->breaks : std::vector<BondBreak>{};
}

void GrainSimulation::stop_all() {
  SavedState state = save();
  GrainSystem& system = implementation_->system;
  system.lost.lost_dashpot += implementation_->potential_and_kinetic().second;
  state["losses"].clear();
  for (const EnergyTerm& term : energy_terms(BodyFamily::colliding)) state["losses"].push_back(system.lost.*term.value);
  std::fill(state["velocities"].begin(), state["velocities"].end(), 0.0);
  restore(state);
}

void GrainSimulation::restore(const SavedState& state) {
  go_back_to(state);
  implementation_->kept = {};
}

void GrainSimulation::go_back_to(const SavedState& state) {
  GrainSystem& system = implementation_->system;
  const ContactColumns columns(system);
  const bool shapes = !system.shapes.parts.empty();
  const std::size_t impulses =
      implementation_->keeps_impulses() ? numbers_per_impulse * system.bodies.motions.size() : 0;
  std::vector<BondBreak> breaks;
  std::size_t bonds = system.bonds.tied.size();
  if (const auto& breakable = system.bonds.breakable) {
    breaks = breaks_of(state["breaks"]);
    check_breaks(system, breaks);
    bonds = breakable->all.size() - breaks.size();
  }
  const std::vector<double>&places = state["motions"], &velocities = state["velocities"], &contacts = state["contacts"];
  const std::vector<double>&losses = state["losses"], &counts = state["counters"];
  if (places.size() != 3 * system.bodies.motions.size() || velocities.size() != places.size() ||
      contacts.size() % columns.count != 0 || state["impulses"].size() != impulses ||
      state["bonds"].size() != numbers_per_bond * bonds ||
      losses.size() != energy_terms(BodyFamily::colliding).size() || counts.size() != std::size(counters_saved) ||
      state["walls"].size() != numbers_per_wall * system.walls.loads.size() ||
      state["servos"].size() != std::size(servo_saved) * system.walls.servos.size() || state["start"].size() != 2) {
    bad_input(fmt::format("the state is of {}", counted(static_cast<long long>(places.size() / 3), "grain")),
              fmt::format("the scene has {}", system.bodies.motions.size()),
              "Resume with the scene that the state was saved from");
  }
  if (system.bonds.breakable) restore_breaks(system, std::move(breaks));
  system.step = state.step;
  implementation_->potential_at_start = state["start"][0];
  implementation_->energy_at_start = state["start"][1];
  if (system.cell.active) {
    const std::vector<double>& crossed = state["crossed"];
    if (crossed.size() != numbers_per_image * system.bodies.motions.size() || !take_numbers(state["cell"], system.cell))
      bad_input("the state is of another periodic cell", "it has other numbers than this one",
                "Resume with the scene that the state was saved from");
    for (std::size_t k = 0; k < system.cell.crossed.size(); ++k)
      system.cell.crossed[k] = image_of(crossed.data() + numbers_per_image * system.bodies.grain_of[k], 0);
  }
  const double* loss = losses.data();
  for (const EnergyTerm& term : energy_terms(BodyFamily::colliding)) system.lost.*term.value = *loss++;
  for (std::size_t k = 0; k < system.bodies.motions.size(); ++k) {
    const double *x = places.data() + 3 * system.bodies.grain_of[k],
                 *v = velocities.data() + 3 * system.bodies.grain_of[k];
    system.bodies.motions[k] = {{x[0], x[1]}, {v[0], v[1]}, v[2], x[2]};
    if (impulses == 0) continue;
    const double* push = state["impulses"].data() + numbers_per_impulse * k;
    system.bodies.impulses[k] = {{push[0], push[1]}, push[2]};
  }
  system.bodies.cleared = false;
  for (std::size_t b = 0; b < bonds; ++b) {
    const double* impulse = state["bonds"].data() + numbers_per_bond * b;
    take_last_impulse(system, system.bonds.tied[b], {impulse[0], impulse[1], impulse[2]});
  }
  const double* wall = state["walls"].data();
  for (WallLoad& load : system.walls.loads) {
    load = {{wall[0], wall[1]}, {wall[2], wall[3]}, wall[4], wall[5]};
    wall += numbers_per_wall;
  }
  const double* servo_number = state["servos"].data();
  for (ServoState& servo : system.walls.servos)
    for (const auto number : servo_saved) servo.*number = *servo_number++;
  system.free_flight = false;
  system.deepest = std::numeric_limits<double>::infinity();  // not known: verlet has to look
  find_images_of_bonds(system);
  place_walls(system);
  turn_axes(system);
  system.contacts.candidates.clear();
  system.contacts.exact_pairs.clear();
  system.contacts.part_pairs.clear();
  std::vector<Candidate> near;
  std::vector<ImagedContact> imaged;
  std::vector<std::pair<Candidate, PartPair>> near_parts;
  std::vector<const double*> others;
  for (std::size_t at = 0; at < contacts.size(); at += columns.count) {
    Candidate contact;
    take(contacts.data() + at, contact);
    const double* numbers = contacts.data() + at;
    const bool discs = contact.j >= 0 && are_discs(system, contact.i, contact.j);
    const bool listed = contact.j >= 0 && (discs ? system.contacts.near.active : system.contacts.near_parts.active);
    if (listed && system.cell.active) {
      imaged.push_back({contact, shapes ? pair_of(numbers + columns.part) : PartPair{},
                        image_of(numbers + columns.image, contact.j)});
    } else if (listed && discs) {
      near.push_back(contact);
    } else if (listed) {
      near_parts.emplace_back(contact, pair_of(numbers + columns.part));
    } else {
      others.push_back(numbers);
    }
  }
  if (system.contacts.near.active) load_pair_bodies(system);
  if (system.meets_images()) {
    list_contacts(system, imaged);
  } else {
    if (system.contacts.near.active) take_near_pairs(system, near);
    if (system.contacts.near_parts.active) take_near_parts(system, std::move(near_parts));
  }
  find_candidates(system);
  std::size_t c = 0;
  for (const double* contact : others) {
    const auto i = static_cast<std::int32_t>(contact[0]);
    const auto j = static_cast<std::int32_t>(contact[1]);
    const double* numbers = contact + columns.part;
    const auto is_it = [&] {
      if (system.contacts.candidates[c].i != i || system.contacts.candidates[c].j != j) return false;
      return !shapes || is_of(numbers, system.contacts.part_pairs[c]);
    };
    while (c < system.contacts.candidates.size() && !is_it()) ++c;
    if (c == system.contacts.candidates.size()) {
      bad_input("the state has a contact of bodies that are apart", "it is of another scene, or damaged",
                "Resume with the scene that the state was saved from");
    }
    take(contact, system.contacts.candidates[c]);
    if (!shapes) continue;
    system.contacts.part_pairs[c].arm_i = {numbers[2], numbers[3]};
    system.contacts.part_pairs[c].arm_j = {numbers[4], numbers[5]};
  }
  const double* count = counts.data();
  for (const auto counter : counters_saved) system.counters.*counter = static_cast<std::int64_t>(*count++);
}

}  // namespace equidem
