// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/contacts/bond_step.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {
namespace {

/// Places of bodies and walls in the loops of two simulations, one after the other; -1: there is none.
struct Places {
  std::vector<std::int32_t> bodies_now, bodies_then;  ///< of the bodies of the first, and of those of the second
  std::vector<std::int32_t> walls_now, walls_then;

  Places(const GrainSystem& old, const GrainSystem& own, const SceneOrigins& origins)
      : bodies_now(old.bodies.grain_of.size(), -1),
        bodies_then(own.bodies.grain_of.size(), -1),
        walls_now(old.scene.walls.size(), -1),
        walls_then(own.scene.walls.size(), -1) {
    for (std::size_t k = 0; k < bodies_then.size(); ++k) {
      const std::int32_t origin = origins.bodies[own.bodies.grain_of[k]];
      if (origin < 0) continue;
      bodies_then[k] = old.bodies.place_of_grain[origin];
      bodies_now[bodies_then[k]] = static_cast<std::int32_t>(k);
    }
    for (std::size_t w = 0; w < walls_then.size(); ++w) {
      const std::int32_t origin = origins.walls[own.walls.wall_of[w]];
      if (origin < 0) continue;
      walls_then[w] = static_cast<std::int32_t>(old.walls.place_of_wall[origin]);
      walls_now[walls_then[w]] = static_cast<std::int32_t>(w);
    }
  }
  /// The number that a body or a wall (negative) of the first has now, as Candidate::j; none: it is gone.
  [[nodiscard]] std::optional<std::int32_t> partner(std::int32_t j) const {
    const std::int32_t now = j >= 0 ? bodies_now[j] : walls_now[~j];
    if (now < 0) return {};
    return j >= 0 ? now : ~now;
  }
  [[nodiscard]] bool is_new(std::int32_t j) const { return (j >= 0 ? bodies_then[j] : walls_then[~j]) < 0; }
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

/// Whether a contact has friction. \param i, j as in Candidate
bool has_friction(const GrainSystem& system, std::int32_t i, std::int32_t j) {
  return system.properties(i, j).friction > 0;
}

/// The image of j that i has in a fresh state, whose bodies are inside the cell, where bodies of both simulations stay
/// where they were without it; new bodies stay inside.
void move_image(const Places& places, const GrainState& fresh, std::int32_t i, std::int32_t j, PeriodicImage& image) {
  const auto moved = [&](std::int32_t body) {
    return places.bodies_then[body] < 0 ? PeriodicImage{} : fresh.crossed[body];
  };
  image.a += moved(i).a - moved(j).a;
  image.b += moved(i).b - moved(j).b;
}

/// Breaks, and the states of bonds that both have; bonds whose discs are gone push no more.
void take_over_bonds(const GrainSystem& old, GrainSystem& own, const Places& places, const SceneOrigins& origins,
                     const GrainState& fresh, GrainState& state) {
  state.breaks.clear();
  for (BondBreak event : old.bonds.breaks) {
    const auto now = std::ranges::find(origins.bonds, static_cast<std::int32_t>(event.bond));
    if (now == origins.bonds.end()) continue;
    event.bond = static_cast<std::size_t>(now - origins.bonds.begin());
    state.breaks.push_back(event);
  }
  restore_breaks(own, state.breaks);
  state.bonds = fresh.bonds;
  for (std::size_t b = 0; b < state.bonds.size(); ++b) {
    const TiedPair& bond = own.bonds.tied[b];
    const std::int32_t i = places.bodies_then[bond.i], j = places.bodies_then[bond.j];
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

/// Rows in the order of one simulation from those of another one. \param rows of what is new, and the length
template <class Row>
std::vector<Row> rows_now(const std::vector<Row>& then, std::vector<Row> rows,
                          const std::vector<std::int32_t>& places_then) {
  for (std::size_t k = 0; k < rows.size() && !then.empty(); ++k)
    if (places_then[k] >= 0) rows[k] = then[places_then[k]];
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
    } else if (*j < 0 || !is_tied(own, *i, *j)) {
      contact.part_i += first_part(own, *i) - first_part(old, contact.i);
      contact.part_j += first_part(own, *j) - first_part(old, contact.j);
      contact.i = *i;
      contact.j = *j;
      // without friction there is no spring; later friction begins anew
      if (!has_friction(own, *i, *j)) contact.stretch = 0;
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

void GrainSimulation::change(const GrainScene& scene, const SceneOrigins& origins) {
  const GrainSystem& system = implementation_->system;
  check(scene, system.options, {}, origins.bodies);
  std::vector<std::size_t> order(origins.bodies.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t body) {
    return origins.bodies[body] < 0 ? INT32_MAX : system.bodies.place_of_grain[origins.bodies[body]];
  });
  auto next = hidden<Implementation>(scene, system.options, order);
  next->take_over(*implementation_, origins);
  implementation_ = std::move(next);
}

void GrainSimulation::Implementation::take_over(const Implementation& before, const SceneOrigins& origins) {
  const GrainSystem& old = before.system;
  GrainSystem& own = system;
  const Places places(old, own, origins);
  const GrainState fresh = this->state();
  GrainState state = before.state();
  state.motions = rows_now(state.motions, fresh.motions, places.bodies_then);
  state.crossed = rows_now(state.crossed, fresh.crossed, places.bodies_then);
  // impulses of bodies that are gone are still needed
  state.impulses = state.impulses.empty()
                       ? fresh.impulses
                       : rows_now(state.impulses, std::vector<BodyImpulse>(fresh.impulses.size()), places.bodies_then);
  take_over_bonds(old, own, places, origins, fresh, state);
  take_over_contacts(old, own, places, fresh, state);
  state.start = fresh.start;
  // walls and servos that both have go on
  state.walls = rows_now(state.walls, fresh.walls, places.walls_then);
  std::vector<std::int32_t> servos_then;
  for (const ServoState& servo : own.walls.servos) {
    const auto then = std::ranges::find_if(old.walls.servos, [&](const ServoState& other) {
      return static_cast<std::int32_t>(other.wall) == places.walls_then[servo.wall];
    });
    servos_then.push_back(then == old.walls.servos.end() ? -1
                                                         : static_cast<std::int32_t>(then - old.walls.servos.begin()));
  }
  state.servos = rows_now(state.servos, fresh.servos, servos_then);
  for (ServoMotion& servo : state.servos) servo.way = 0;  // what servo walls have gone is in their places
  go_back_to(state);
  // bodies that have left the cell are where they are, not at their images inside
  at_start.potential = potential_and_kinetic().first;
  for (ServoState& servo : own.walls.servos) servo.count_anew();
  if (own.cell.active && begin_controls(old, own)) measure_resistance(own);
  if (own.cell.deforms && !old.cell.deforms) begin_cell_stress(own, contacts());
}

}  // namespace equidem
