// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <optional>
#include <utility>

#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/contacts/bond_step.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"
#include "equidem/grains/neighbours/near_parts.hpp"

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
      bodies_then[k] = old.bodies.place_of_grain[static_cast<std::size_t>(origin)];
      bodies_now[static_cast<std::size_t>(bodies_then[k])] = static_cast<std::int32_t>(k);
    }
    for (std::size_t w = 0; w < walls_then.size(); ++w) {
      const std::int32_t origin = origins.walls[own.walls.wall_of[w]];
      if (origin < 0) continue;
      walls_then[w] = static_cast<std::int32_t>(old.walls.place_of_wall[static_cast<std::size_t>(origin)]);
      walls_now[static_cast<std::size_t>(walls_then[w])] = static_cast<std::int32_t>(w);
    }
  }
  /// The number that a body or a wall (negative) of the first has now, as Candidate::j; none: it is gone.
  [[nodiscard]] std::optional<std::int32_t> partner(std::int32_t j) const {
    const std::int32_t now = j >= 0 ? bodies_now[static_cast<std::size_t>(j)] : walls_now[static_cast<std::size_t>(~j)];
    if (now < 0) return {};
    return j >= 0 ? now : ~now;
  }
  [[nodiscard]] bool is_new(std::int32_t j) const {
    return (j >= 0 ? bodies_then[static_cast<std::size_t>(j)] : walls_then[static_cast<std::size_t>(~j)]) < 0;
  }
};

/// A contact in the state of a system.
struct SavedContact {
  const GrainSystem& system;
  ContactColumns at;
  double* numbers;

  SavedContact(const GrainSystem& of, double* row) : system(of), at(of), numbers(row) {}
  [[nodiscard]] std::int32_t i() const { return static_cast<std::int32_t>(numbers[at.i]); }
  [[nodiscard]] std::int32_t j() const { return static_cast<std::int32_t>(numbers[at.j]); }
  [[nodiscard]] Vec2 vector(std::size_t column) const { return {numbers[column], numbers[column + 1]}; }
  [[nodiscard]] Vec2 normal() const { return vector(at.normal); }
  [[nodiscard]] Vec2 impulse_on_j() const {
    return numbers[at.impulse] * normal() + numbers[at.tangential_impulse] * perpendicular(normal());
  }
  /// From the centres of i and j to the contact point.
  [[nodiscard]] std::array<Vec2, 2> arms() const {
    // those of two discs are not in the state
    if (!system.shapes.parts.empty() && (j() < 0 || !are_discs(system, i(), j())))
      return {vector(at.arm), vector(at.arm + 2)};
    const double radius = system.bodies.constants[static_cast<std::size_t>(i())].radius;
    if (j() < 0) return {radius * normal(), {}};
    const double sum = radius + system.bodies.constants[static_cast<std::size_t>(j())].radius;
    const double distance = sum - numbers[at.overlap], lever = radius / sum * distance;
    return {lever * normal(), (lever - distance) * normal()};
  }
  /// The row of the same contact in another system, which may be the first or the last with shapes.
  [[nodiscard]] std::vector<double> row_in(const GrainSystem& own, std::int32_t new_i, std::int32_t new_j) const {
    const ContactColumns to(own);
    std::vector<double> row(numbers, numbers + at.part);
    row[to.i] = new_i;
    row[to.j] = new_j;
    if (own.shapes.parts.empty()) return row;
    const auto part = [&](std::size_t column, std::int32_t from, std::int32_t body) {
      const double first = own.shapes.first_part[static_cast<std::size_t>(body)];
      return system.shapes.parts.empty()
                 ? first
                 : first + numbers[column] - system.shapes.first_part[static_cast<std::size_t>(from)];
    };
    const auto [arm_i, arm_j] = arms();
    row.insert(row.end(), {part(at.part, i(), new_i), new_j < 0 ? 0 : part(at.part + 1, j(), new_j), arm_i.x, arm_i.y,
                           arm_j.x, arm_j.y});
    return row;
  }
  /// The image of j seen from where the state has the bodies, not from their places inside the cell.
  /// \param crossed as GrainSimulation::save writes it, of the bodies inside
  void leave_cell(const std::vector<double>& crossed) {
    if (!system.cell.active || j() < 0) return;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto moved = [&](std::int32_t body) {
        return crossed[2 * system.bodies.grain_of[static_cast<std::size_t>(body)] + k];
      };
      numbers[at.image + k] += moved(i()) - moved(j());
    }
  }
};

/// Impulses of bodies as GrainSimulation::save writes them; none where steps do not need those of the last one.
struct SavedImpulses {
  std::vector<double>& numbers;

  void add(std::optional<std::int32_t> body, Vec2 impulse, double torque) {
    if (numbers.empty() || !body) return;
    double* const given = numbers.data() + 3 * static_cast<std::size_t>(*body);
    given[0] += impulse.x;
    given[1] += impulse.y;
    given[2] += torque;
  }
  /// \param factor -1: the impulses are taken back; i and j of its bodies, if they are there
  void add(const SavedContact& contact, double factor, std::optional<std::int32_t> i, std::optional<std::int32_t> j) {
    const Vec2 on_j = factor * contact.impulse_on_j();
    const auto [arm_i, arm_j] = contact.arms();
    add(i, -on_j, -cross(arm_i, on_j));
    if (j && *j >= 0) add(j, on_j, cross(arm_j, on_j));
  }
};

bool is_tied(const GrainSystem& system, std::int32_t i, std::int32_t j) {
  const auto at = place_of_bond(system.bonds.tied, i, j);
  return at != system.bonds.tied.end() && at->i == i && at->j == j;
}

/// Whether a contact has friction. \param i, j as in Candidate
bool rubs(const GrainSystem& system, std::int32_t i, std::int32_t j) {
  Candidate candidate;
  candidate.i = i;
  candidate.j = j;
  return system.properties(candidate).friction > 0;
}

/// Breaks, and the last impulses of bonds that both have; bonds whose discs are gone push no more.
void take_over_bonds(const GrainSystem& old, GrainSystem& own, const Places& places, const SceneOrigins& origins,
                     SavedState& state) {
  if (own.bonds.breakable) {
    std::vector<BondBreak> breaks;
    for (std::size_t b = 0; old.bonds.breakable && b < old.bonds.breakable->breaks.size(); ++b) {
      BondBreak event = old.bonds.breakable->breaks[b];
      const auto now = std::ranges::find(origins.bonds, static_cast<std::int32_t>(event.bond));
      if (now == origins.bonds.end()) continue;
      event.bond = static_cast<std::size_t>(now - origins.bonds.begin());
      breaks.push_back(event);
    }
    const auto at = std::ranges::find(state.arrays, "breaks", &SavedArray::name);
    SavedArray saved{"breaks", numbers_per_break, numbers_of(breaks)};
    at == state.arrays.end() ? state.arrays.push_back(std::move(saved)) : void(*at = std::move(saved));
    restore_breaks(own, std::move(breaks));
  }
  std::vector<double>& impulses = state["bonds"];
  impulses.clear();
  for (const TiedPair& bond : own.bonds.tied) {
    const std::int32_t i = places.bodies_then[static_cast<std::size_t>(bond.i)],
                       j = places.bodies_then[static_cast<std::size_t>(bond.j)];
    const bool both = i >= 0 && j >= 0 && is_tied(old, i, j);
    const BondModes last = both ? last_impulse(old, *place_of_bond(old.bonds.tied, i, j)) : BondModes{};
    impulses.insert(impulses.end(), {last.normal, last.tangential, last.rolling});
  }
  SavedImpulses on_bodies{state["impulses"]};
  for (const TiedPair& bond : old.bonds.tied) {
    const auto i = places.partner(bond.i), j = places.partner(bond.j);
    if (i && j) continue;
    const auto [on_i, on_j] = impulses_of_bond(old, bond);
    on_bodies.add(i, -on_i.impulse, -on_i.torque);
    on_bodies.add(j, -on_j.impulse, -on_j.torque);
  }
}

/// Rows of bodies in the order of one simulation from those of another one.
/// \param rows of new bodies, and the length of the result
std::vector<double> rows_now(const std::vector<double>& then, std::vector<double> rows, std::size_t columns,
                             const std::vector<std::int32_t>& places_then) {
  if (then.empty() || rows.empty()) return rows;
  for (std::size_t k = 0; k < places_then.size(); ++k)
    if (places_then[k] >= 0)
      std::copy_n(then.begin() + static_cast<std::ptrdiff_t>(columns) * places_then[k], columns,
                  rows.begin() + static_cast<std::ptrdiff_t>(columns * k));
  return rows;
}

std::size_t columns_of(const SavedState& state, const char* name) {
  return std::ranges::find(state.arrays, name, &SavedArray::name)->columns;
}

/// Contacts that go on, those that begin because a body or a wall is new, and the impulses without those that are gone.
void take_over_contacts(const GrainSystem& old, const GrainSystem& own, const Places& places, SavedState fresh,
                        SavedState& state) {
  const auto saved = std::ranges::find(state.arrays, "contacts", &SavedArray::name);
  SavedImpulses impulses{state["impulses"]};
  std::vector<std::vector<double>> kept;
  std::vector<double>& contacts = saved->values;
  for (std::size_t at = 0; at < contacts.size(); at += saved->columns) {
    SavedContact contact(old, contacts.data() + at);
    const auto i = places.partner(contact.i()), j = places.partner(contact.j());
    if (!i || !j) {
      impulses.add(contact, -1, i, j);
    } else if (*j < 0 || !is_tied(own, *i, *j)) {
      kept.push_back(contact.row_in(own, *i, *j));
      // without friction there is no spring; later friction begins anew
      if (!rubs(own, *i, *j)) kept.back()[contact.at.stretch] = 0;
    }
  }
  // new bodies stay where they are inside
  std::vector<double> moved = own.cell.active ? fresh["crossed"] : std::vector<double>();
  for (std::size_t k = 0; k < places.bodies_then.size() && own.cell.active; ++k)
    if (places.bodies_then[k] < 0)
      std::fill_n(moved.begin() + 2 * static_cast<std::ptrdiff_t>(own.bodies.grain_of[k]), 2, 0.0);
  std::vector<double>& begun = fresh["contacts"];
  saved->columns = columns_of(fresh, "contacts");
  for (std::size_t at = 0; at < begun.size(); at += saved->columns) {
    SavedContact contact(own, begun.data() + at);
    if (!places.is_new(contact.i()) && !places.is_new(contact.j())) continue;
    impulses.add(contact, 1, contact.i(), contact.j());
    contact.leave_cell(moved);
    kept.emplace_back(contact.numbers, contact.numbers + saved->columns);
    state["counters"][1] += 1;
  }
  // walls may stand in another order, in which restore() looks for their contacts
  const auto rank = [](double j) { return j >= 0 ? std::pair(0, j) : std::pair(1, -j); };
  std::ranges::stable_sort(kept, [&](const std::vector<double>& a, const std::vector<double>& b) {
    return std::pair(a[0], rank(a[1])) < std::pair(b[0], rank(b[1]));
  });
  contacts.clear();
  for (const std::vector<double>& row : kept) contacts.insert(contacts.end(), row.begin(), row.end());
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

void GrainSimulation::take_over(const GrainSimulation& before, const SceneOrigins& origins) {
  const GrainSystem& old = before.implementation_->system;
  GrainSystem& own = implementation_->system;
  const Places places(old, own, origins);
  const SavedState fresh = save();
  SavedState state = before.save();
  assert(
      std::ranges::is_sorted(places.bodies_then, {}, [](std::int32_t place) { return place < 0 ? INT32_MAX : place; }));
  // in the order of the caller
  state["motions"] = rows_now(state["motions"], fresh["motions"], 3, origins.bodies);
  state["velocities"] = rows_now(state["velocities"], fresh["velocities"], 3, origins.bodies);
  if (own.cell.active) state["crossed"] = rows_now(state["crossed"], fresh["crossed"], 2, origins.bodies);
  // in the order of the loops; impulses of bodies that are gone are still needed
  std::vector<double> resting(fresh["impulses"].size(), 0.0);
  const bool had_impulses = !state["impulses"].empty();
  state["impulses"] =
      had_impulses ? rows_now(state["impulses"], std::move(resting), 3, places.bodies_then) : fresh["impulses"];
  take_over_bonds(old, own, places, origins, state);
  take_over_contacts(old, own, places, fresh, state);
  state["start"] = fresh["start"];
  // walls and servos that both have go on
  const auto carry = [&](const char* name, const auto& old_place_of) {
    const std::size_t numbers = columns_of(fresh, name);
    std::vector<std::int32_t> then;
    for (std::size_t k = 0; k < fresh[name].size() / numbers; ++k) then.push_back(old_place_of(k));
    state[name] = rows_now(state[name], fresh[name], numbers, then);
  };
  carry("walls", [&](std::size_t w) { return places.walls_then[w]; });
  carry("servos", [&](std::size_t s) -> std::int32_t {
    const std::int32_t wall = places.walls_then[own.walls.servos[s].wall];
    for (std::size_t k = 0; k < old.walls.servos.size(); ++k)
      if (static_cast<std::int32_t>(old.walls.servos[k].wall) == wall) return static_cast<std::int32_t>(k);
    return -1;
  });
  // what servo walls have gone is in their places
  for (std::size_t at = 0; at < state["servos"].size(); at += columns_of(fresh, "servos")) state["servos"][at] = 0;
  restore(state);
  // bodies that have left the cell are where they are, not at their images inside
  implementation_->potential_at_start = implementation_->potential_and_kinetic().first;
  for (ServoState& servo : own.walls.servos) servo.count_anew();
  if (own.cell.active && begin_controls(old, own)) measure_resistance(own);
  if (own.cell.deforms && !old.cell.deforms) begin_cell_stress(own, contacts());
}

}  // namespace equidem
