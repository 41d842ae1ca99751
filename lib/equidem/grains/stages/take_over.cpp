// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <utility>

#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {
namespace {

/// The scene with its bodies at the places and with the motions of others.
GrainScene with_motions(GrainScene scene, const std::vector<DiscMotion>& places,
                        const std::vector<DiscMotion>& velocities) {
  for (std::size_t g = 0; g < scene.grains.size(); ++g) {
    Grain& grain = scene.grains[g];
    grain.position = places[g].u;
    grain.angle = places[g].theta;
    grain.velocity = velocities[g].u;
    grain.spin = velocities[g].theta;
  }
  return scene;
}

/// The place of each wall among others of the same name; -1: there is none.
std::vector<std::int32_t> places_among(const std::vector<Wall>& walls, const std::vector<Wall>& others) {
  std::vector<std::int32_t> places;
  for (const Wall& wall : walls) {
    const auto found = std::ranges::find(others, wall.name, &Wall::name);
    places.push_back(found == others.end() ? -1 : static_cast<std::int32_t>(found - others.begin()));
  }
  return places;
}

/// A contact as GrainSimulation::save writes it.
struct SavedContact {
  double* numbers;

  [[nodiscard]] std::size_t i() const { return static_cast<std::size_t>(numbers[0]); }
  [[nodiscard]] std::int32_t j() const { return static_cast<std::int32_t>(numbers[1]); }
  [[nodiscard]] Vec2 normal() const { return {numbers[7], numbers[8]}; }
  [[nodiscard]] Vec2 impulse_on_wall() const { return numbers[9] * normal() + numbers[11] * perpendicular(normal()); }
};

bool is_tied(const GrainSystem& system, std::int32_t i, std::int32_t j) {
  const std::vector<TiedPair>& tied = system.bonds.tied;
  const auto at = place_of_bond(tied, i, j);
  return at != tied.end() && at->i == i && at->j == j;
}

/// Breaks, and the last impulses of bonds that both have.
void take_over_bonds(const GrainSystem& old, GrainSystem& own, SavedState& state, bool verlet) {
  if (own.bonds.breakable) {
    if (old.bonds.breakable) {
      restore_breaks(own, old.bonds.breakable->breaks);
    } else {
      state.arrays.push_back({"breaks", numbers_per_break, {}});
    }
  }
  std::vector<double>& impulses = state["bonds"];
  impulses.clear();
  if (!verlet) return;
  for (const TiedPair& bond : own.bonds.tied) {
    const bool both = is_tied(old, bond.i, bond.j);
    const BondModes last = both ? last_impulse(old, *place_of_bond(old.bonds.tied, bond.i, bond.j)) : BondModes{};
    impulses.insert(impulses.end(), {last.normal, last.tangential, last.rolling});
  }
}

}  // namespace

GrainSimulation::GrainSimulation(const GrainScene& scene, const GrainOptions& options, const GrainSimulation& before,
                                 const std::vector<DiscMotion>& places, const std::vector<DiscMotion>& velocities)
    : GrainSimulation(with_motions(scene, places, velocities), options,
                      before.implementation_->system.bodies.grain_of) {}

void GrainSimulation::take_over(const GrainSimulation& before) {
  const GrainSystem& old = before.implementation_->system;
  GrainSystem& own = implementation_->system;
  SavedState state = before.save();
  take_over_bonds(old, own, state, implementation_->verlet());
  const std::vector<std::int32_t> now_at = places_among(old.scene.walls, own.scene.walls);
  const bool shapes = !own.shapes.parts.empty();
  const std::size_t columns = std::ranges::find(state.arrays, "contacts", &SavedArray::name)->columns;
  std::vector<double>& impulses = state["impulses"];
  std::vector<std::vector<double>> kept;
  std::vector<double>& contacts = state["contacts"];
  for (std::size_t at = 0; at < contacts.size(); at += columns) {
    const SavedContact contact{contacts.data() + at};
    if (contact.j() >= 0 && is_tied(own, static_cast<std::int32_t>(contact.i()), contact.j())) continue;
    if (contact.j() >= 0 || now_at[static_cast<std::size_t>(~contact.j())] >= 0) {
      if (contact.j() < 0) contact.numbers[1] = static_cast<double>(~now_at[static_cast<std::size_t>(~contact.j())]);
      kept.emplace_back(contact.numbers, contact.numbers + columns);
    } else if (!impulses.empty()) {
      // a wall that is gone gives nothing to the step that follows
      const Vec2 on_wall = contact.impulse_on_wall();
      const Vec2 arm = shapes ? Vec2{contact.numbers[15], contact.numbers[16]}
                              : old.bodies.constants[contact.i()].radius * contact.normal();
      double* const given = impulses.data() + 3 * contact.i();
      given[0] += on_wall.x;
      given[1] += on_wall.y;
      given[2] += cross(arm, on_wall);
    }
  }
  // walls may stand in another order, in which restore() looks for their contacts
  const auto rank = [](double j) { return j >= 0 ? std::pair(0, j) : std::pair(1, -j); };
  std::ranges::stable_sort(kept, [&](const std::vector<double>& a, const std::vector<double>& b) {
    return std::pair(a[0], rank(a[1])) < std::pair(b[0], rank(b[1]));
  });
  contacts.clear();
  for (const std::vector<double>& row : kept) contacts.insert(contacts.end(), row.begin(), row.end());
  const SavedState fresh = save();
  if (fresh["impulses"].size() != impulses.size()) impulses = fresh["impulses"];
  state["start"] = fresh["start"];
  // walls and servos that both have go on
  const auto carry = [&](const char* name, const auto& old_place_of) {
    const std::size_t numbers = std::ranges::find(fresh.arrays, name, &SavedArray::name)->columns;
    std::vector<double> carried = fresh[name];
    const std::vector<double>& from = state[name];
    for (std::size_t k = 0; k < carried.size() / numbers; ++k) {
      const std::int32_t there = old_place_of(k);
      if (there < 0) continue;
      std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(numbers) * there, numbers,
                  carried.begin() + static_cast<std::ptrdiff_t>(numbers * k));
    }
    state[name] = std::move(carried);
  };
  const std::vector<std::int32_t> then_at = places_among(own.scene.walls, old.scene.walls);
  carry("walls", [&](std::size_t w) { return then_at[w]; });
  carry("servos", [&](std::size_t s) -> std::int32_t {
    const std::int32_t wall = then_at[own.walls.servos[s].wall];
    for (std::size_t k = 0; k < old.walls.servos.size(); ++k)
      if (static_cast<std::int32_t>(old.walls.servos[k].wall) == wall) return static_cast<std::int32_t>(k);
    return -1;
  });
  // what servo walls have gone is in their places
  const std::size_t numbers = std::ranges::find(fresh.arrays, "servos", &SavedArray::name)->columns;
  for (std::size_t at = 0; at < state["servos"].size(); at += numbers) state["servos"][at] = 0;
  restore(state);
  for (ServoState& servo : implementation_->system.walls.servos)
    servo.overshoot = servo.errors = servo.steps = servo.largest_wanted = servo.reached = servo.side = 0;
}

}  // namespace equidem
