// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>

#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {
namespace {

/// Bodies and walls in the loops of two simulations of a run, one after the other.
struct Places {
  const GrainSystem &old, &own;
  std::vector<std::int32_t> walls_then = {};  ///< of the walls of the second in the first; -1: they are new

  Places(const GrainSystem& first, const GrainSystem& second, const std::vector<std::int32_t>& walls)
      : old(first), own(second) {
    for (const std::size_t wall : own.walls.wall_of)
      walls_then.push_back(walls[wall] < 0 ? -1 : old.walls.place_of_wall[walls[wall]]);
  }
  /// The number that a body or a wall (negative) of the first has now, as Candidate::j; none: it is gone.
  [[nodiscard]] std::optional<std::int32_t> partner(std::int32_t j) const {
    if (j >= 0) {
      const std::int32_t now = own.bodies.place_of_grain[old.bodies.grain_of[j]];
      return now < 0 ? std::optional<std::int32_t>() : now;
    }
    const auto now = std::ranges::find(walls_then, ~j);
    if (now == walls_then.end()) return {};
    return ~static_cast<std::int32_t>(now - walls_then.begin());
  }
  /// The number of a body of the second in the first; -1: it is new.
  [[nodiscard]] std::int32_t then(std::int32_t body) const {
    return old.bodies.place_of_grain[own.bodies.grain_of[body]];
  }
  [[nodiscard]] bool is_new(std::int32_t j) const { return (j >= 0 ? then(j) : walls_then[~j]) < 0; }
};

/// Impulses of bodies; none where steps do not need those of the last one.
struct PastImpulses {
  std::vector<BodyImpulse>& impulses;

  void add(std::optional<std::int32_t> body, Vec2 impulse, double torque) {
    if (impulses.empty() || !body) return;
    impulses[*body].impulse += impulse;
    impulses[*body].torque += torque;
  }
  /// \param factor -1: the impulses are taken back; i and j of its bodies, if they are there
  void add(const ContactState& contact, double factor, std::optional<std::int32_t> i, std::optional<std::int32_t> j) {
    const Vec2 on_j =
        factor * (contact.impulse * contact.normal + contact.tangential_impulse * perpendicular(contact.normal));
    const double rolling = factor * contact.lever * contact.rolling_impulse;
    add(i, -on_j, -cross(contact.arm_i, on_j) - rolling);
    if (j && *j >= 0) add(j, on_j, cross(contact.arm_j, on_j) + rolling);
  }
};

bool is_tied(const GrainSystem& system, std::int32_t i, std::int32_t j) {
  const auto at = place_of_bond(system.bonds.tied, i, j);
  return at != system.bonds.tied.end() && at->i == i && at->j == j && !at->broken;
}

/// The image of j that i has in a fresh state, whose bodies are inside the cell, where bodies of both simulations stay
/// where they were without it; new bodies stay inside.
void move_image(const Places& places, const GrainState& fresh, std::int32_t i, std::int32_t j, PeriodicImage& image) {
  const auto moved = [&](std::int32_t body) { return places.is_new(body) ? PeriodicImage{} : fresh.crossed[body]; };
  image.a += moved(i).a - moved(j).a;
  image.b += moved(i).b - moved(j).b;
}

/// The states of bonds that both have; bonds whose discs are gone push no more.
void take_over_bonds(const GrainSystem& old, GrainSystem& own, const Places& places, const GrainState& fresh,
                     GrainState& state) {
  restore_breaks(own, state.breaks);
  state.bonds = fresh.bonds;
  for (std::size_t b = 0; b < state.bonds.size(); ++b) {
    const TiedPair& bond = own.bonds.tied[b];
    const std::int32_t i = places.then(bond.i), j = places.then(bond.j);
    if (i >= 0 && j >= 0 && is_tied(old, i, j)) {
      state.bonds[b] = state_of(old, *place_of_bond(old.bonds.tied, i, j));
      continue;
    }
    state.bonds[b].impulse = {};  // it gives none before its first step
    if (own.cell.active) move_image(places, fresh, bond.i, bond.j, state.bonds[b].image);
  }
  PastImpulses on_bodies{state.impulses};
  for (const TiedPair& bond : old.bonds.holding()) {
    const auto i = places.partner(bond.i), j = places.partner(bond.j);
    if (i && j) continue;
    const auto [on_i, on_j] = impulses_of_bond(old, bond);
    on_bodies.add(i, -on_i.impulse, -on_i.torque);
    on_bodies.add(j, -on_j.impulse, -on_j.torque);
  }
}

/// Rows in the order of one simulation from those of another one.
/// \param rows of what is new, and the length
/// \param then the row in the other one, negative: it has none
template <class Row, class Then>
std::vector<Row> rows_now(const std::vector<Row>& rows_then, std::vector<Row> rows, const Then& then) {
  for (std::size_t k = 0; k < rows.size() && !rows_then.empty(); ++k)
    if (const std::int32_t from = then(static_cast<std::int32_t>(k)); from >= 0) rows[k] = rows_then[from];
  return rows;
}

/// Contacts that go on, those that begin because a body or a wall is new, and the impulses without those that are gone.
void take_over_contacts(const GrainSystem& old, const GrainSystem& own, const Places& places, const GrainState& fresh,
                        GrainState& state) {
  PastImpulses impulses{state.impulses};
  const auto first_part = [](const GrainSystem& system, std::int32_t body) {
    return system.shapes.parts.empty() || body < 0 ? 0 : system.shapes.first_part[body];
  };
  std::vector<ContactState> kept;
  for (ContactState contact : state.contacts) {
    const auto i = places.partner(contact.i), j = places.partner(contact.j);
    if (!i || !j) {
      impulses.add(contact, -1, i, j);
    } else if (*j < 0 || own.bonds.beside_contact || !is_tied(own, *i, *j)) {
      contact.part_i += first_part(own, *i) - first_part(old, contact.i);
      contact.part_j += first_part(own, *j) - first_part(old, contact.j);
      contact.i = *i;
      contact.j = *j;
      // without friction there is no spring; later friction begins anew
      if (!(own.properties(*i, *j).friction > 0)) contact.stretch = 0;
      if (!(own.properties(*i, *j).rolling_friction > 0)) contact.rolling_stretch = 0;
      kept.push_back(contact);
    }
  }
  for (ContactState contact : fresh.contacts) {
    if (!places.is_new(contact.i) && !places.is_new(contact.j)) continue;
    impulses.add(contact, 1, contact.i, contact.j);
    if (own.cell.active && contact.j >= 0) {
      PeriodicImage image{contact.j, contact.b, contact.a};
      move_image(places, fresh, contact.i, contact.j, image);
      contact.a = image.a, contact.b = image.b;
    }
    kept.push_back(contact);
    ++state.counters.contacts;
  }
  // walls may stand in another order, in which their contacts are looked for
  const auto place = [](const ContactState& c) { return std::tuple(c.i, c.j < 0, c.j < 0 ? ~c.j : c.j); };
  std::ranges::stable_sort(kept, {}, place);
  state.contacts = std::move(kept);
}

/// Components that keep a stress in both stages go on at their rate; errors are counted anew.
/// \return whether a component begins to keep one
bool begin_controls(const GrainSystem& old, GrainSystem& own) {
  const auto keeps = [](const GrainSystem& system, std::optional<Schedule> CellServo::*stress) {
    return system.scene.cell->servo && ((*system.scene.cell->servo).*stress).has_value();
  };
  bool any = false;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto stress = k == 0 ? &CellServo::stress_xx : &CellServo::stress_yy;
    CellControl& control = own.cell.controls[k];
    if (keeps(old, stress) && keeps(own, stress)) {
      control.count_anew();
    } else {
      control = {};
      any = any || keeps(own, stress);
    }
  }
  return any;
}

}  // namespace

void GrainSimulation::change(GrainScene scene, const std::vector<std::int32_t>& walls) {
  const GrainSystem& system = implementation_->system;
  if (scene.cell && system.cell.active) {
    const PeriodicCell now = *placed_cell();
    std::tie(scene.cell->width, scene.cell->height, scene.cell->shift) = std::tie(now.width, now.height, now.shift);
  }
  check_properties(scene, system.options);
  check_places(scene, {}, system.bodies.place_of_grain);
  check_bonds(scene, system.options);
  auto next = hidden<Implementation>(scene, system.options, &system);
  next->begin();
  next->take_over(*implementation_, walls);
  implementation_ = std::move(next);
}

void GrainSimulation::restore(const GrainScene& scene, const SavedState& state) {
  const GrainSystem& system = implementation_->system;
  check_properties(scene, system.options);
  check_bonds(scene, system.options);
  auto next = hidden<Implementation>(scene, system.options, &system);
  next->restore(state);
  implementation_ = std::move(next);
}

void GrainSimulation::Implementation::take_over(const Implementation& before, const std::vector<std::int32_t>& walls) {
  const GrainSystem& old = before.system;
  GrainSystem& own = system;
  const Places places(old, own, walls);
  const auto body_then = [&](std::int32_t body) { return places.then(body); };
  const GrainState fresh = this->state();
  GrainState state = before.state();
  state.motions = rows_now(state.motions, fresh.motions, body_then);
  state.crossed = rows_now(state.crossed, fresh.crossed, body_then);
  // impulses of bodies that are gone are still needed
  state.impulses = state.impulses.empty()
                       ? fresh.impulses
                       : rows_now(state.impulses, std::vector<BodyImpulse>(fresh.impulses.size()), body_then);
  take_over_bonds(old, own, places, fresh, state);
  take_over_contacts(old, own, places, fresh, state);
  state.start = fresh.start;
  // walls and servos that both have go on
  state.walls = rows_now(state.walls, fresh.walls, [&](std::int32_t wall) { return places.walls_then[wall]; });
  state.servos = rows_now(state.servos, fresh.servos, [&](std::int32_t servo) {
    const auto then = std::ranges::find_if(old.walls.servos, [&](const ServoState& other) {
      return static_cast<std::int32_t>(other.wall) == places.walls_then[own.walls.servos[servo].wall];
    });
    return static_cast<std::int32_t>(then == old.walls.servos.end() ? -1 : then - old.walls.servos.begin());
  });
  for (std::size_t k = 0; k < state.servos.size(); ++k) {
    state.servos[k].way = 0;  // what servo walls have gone is in their places
    state.servos[k].farthest = fresh.servos[k].farthest;
  }
  go_back_to(state);
  // bodies that have left the cell are where they are, not at their images inside
  at_start.potential = potential_and_kinetic().first;
  for (ServoState& servo : own.walls.servos) servo.count_anew();
  if (own.cell.active && begin_controls(old, own)) measure_resistance(own);
  if (own.cell.deforms && !old.cell.deforms) begin_cell_stress(own, contacts());
}

}  // namespace equidem
