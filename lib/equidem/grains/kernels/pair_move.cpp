// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cstdint>

#include "equidem/grains/contacts/move_bodies.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"

namespace equidem {
namespace {

using Pair = eight::Two;

/// Two numbers anywhere: copied byte by byte they would go through general registers. A struct, because Clang 14 takes
/// an alias of a vector type with less alignment for the aligned type.
struct __attribute__((packed, may_alias)) PairAnywhere {
  Pair value;
};

template <class Number>
EQUIDEM_ALWAYS_INLINE Pair load_pair(const Number& from) {
  return reinterpret_cast<const PairAnywhere*>(&from)->value;
}
/// The number at `to` and the one behind it.
template <class Number>
EQUIDEM_ALWAYS_INLINE void store_pair(const Pair& pair, Number& to) {
  reinterpret_cast<PairAnywhere*>(&to)->value = pair;
}

/// \return the longest way of a body, squared, m²; no number where one is none
template <bool turning>
double move(GrainSystem& system, std::size_t block) {
  const double dt = system.dt();
  const Pair fall = dt * load_pair(system.scene.gravity);
  const std::size_t end = system.bodies.blocks.end(block);
  const GrainBody* bodies = system.bodies.constants.data();
  const GrainMotion* motions = system.bodies.motions.data();
  GrainMotion* next = system.bodies.next.data();
  BodyImpulse* impulses = system.bodies.impulses.data();
  PairBody* pair_bodies = system.contacts.near.bodies.data();
  // Compared by their bits: numbers that are not negative lie in the same order, and no number behind all of them.
  std::uint64_t longest = 0;
  for (std::size_t i = system.bodies.blocks.begin(block); i < end; ++i) {
    const GrainBody& body = bodies[i];
    const GrainMotion& before = motions[i];
    GrainMotion& after = next[i];
    PairBody& seen = pair_bodies[i];
    const Pair gain = body.inverse_mass * load_pair(impulses[i].impulse);
    const Pair velocity = load_pair(before.velocity) + (gain + fall);
    const Pair way = dt * velocity, moved = load_pair(before.position) + way;
    store_pair(moved, after.position);
    store_pair(velocity, after.velocity);
    store_pair(moved, seen.position);
    store_pair(velocity, seen.velocity);
    store_pair(velocity + 0.5 * gain, seen.middle_velocity);
    double spin = before.spin;
    if constexpr (turning) {
      // near pairs gave forces along the rim
      const double torque = impulses[i].torque + body.radius * impulses[i].rim;
      store_pair(Pair{torque, 0}, impulses[i].torque);
      const double turn = body.inverse_moment * torque;
      spin += turn;
      seen.rim_speed = spin * body.radius;
      seen.middle_rim_speed = (spin + 0.5 * turn) * body.radius;
    }
    store_pair(Pair{spin, before.angle + dt * spin}, after.spin);
    const Pair square = way * way;
    longest = std::max(longest, std::bit_cast<std::uint64_t>(square[0] + square[1]));
  }
  return std::bit_cast<double>(longest);
}

}  // namespace

double move_pair_bodies(GrainSystem& system, std::size_t block) {
  const bool turning = system.friction || !system.bonds.tied.empty() || !system.shapes.parts.empty();
  return turning ? move<true>(system, block) : move<false>(system, block);
}

}  // namespace equidem
