// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cstdint>

#include "equidem/grains/contacts/move_bodies.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"
#include "equidem/grains/kernels/vector_width.hpp"

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

/// Four numbers to be stored at once: a store of two costs as much.
template <class Row>
EQUIDEM_ALWAYS_INLINE void store_row(const Pair& low, const Pair& high, void* to) {
  if constexpr (eight::in_halves<Row>) {
    eight::store(Row{low, high}, to);
  } else {
    eight::store(__builtin_shufflevector(low, high, 0, 1, 2, 3), to);
  }
}

/// \tparam turning contacts turn bodies
/// \tparam clears the impulses become zero
template <bool turning, bool clears>
struct MoveBlock {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, std::size_t block);
};

template <bool turning, bool clears>
template <class Lanes>
void MoveBlock<turning, clears>::run(GrainSystem& system, std::size_t block) {
  using Row = eight::Row<Lanes>;
  const double dt = system.dt();
  const Pair fall = dt * load_pair(system.scene.gravity);
  const std::size_t end = system.bodies.blocks.end(block);
  const GrainBody* bodies = system.bodies.constants.data();
  const GrainMotion* motions = system.bodies.motions.data();
  GrainMotion* next = system.bodies.in_place ? system.bodies.motions.data() : system.bodies.next.data();
  BodyImpulse* impulses = system.bodies.impulses.data();
  PairBody* pair_bodies = system.contacts.near.bodies.data();
  // Compared by their bits: numbers that are not negative lie in the same order, and no number behind all of them.
  std::uint64_t longest = 0;
  for (std::size_t i = system.bodies.blocks.begin(block); i < end; ++i) {
    const GrainBody& body = bodies[i];
    const GrainMotion& before = motions[i];
    GrainMotion& after = next[i];
    PairBody& seen = pair_bodies[i];
    BodyImpulse& push = impulses[i];
    const Pair gain = body.inverse_mass * load_pair(push.impulse);
    const Pair velocity = load_pair(before.velocity) + (gain + fall);
    const Pair way = dt * velocity, moved = load_pair(before.position) + way;
    double spin = before.spin;
    Pair rims = load_pair(seen.middle_rim_speed);
    if constexpr (turning) {
      // near pairs gave forces along the rim
      const double torque = push.torque + body.radius * push.rim;
      if constexpr (!clears) store_pair(Pair{torque, 0}, push.torque);
      const double turn = body.inverse_moment * torque;
      spin += turn;
      rims = body.radius * Pair{spin + 0.5 * turn, spin};
    }
    if constexpr (clears) store_row<Row>(Pair{}, Pair{}, &push.impulse);
    store_row<Row>(moved, velocity, &after.position);
    store_pair(Pair{spin, before.angle + dt * spin}, after.spin);
    store_row<Row>(moved, velocity, &seen.position);
    store_row<Row>(velocity + 0.5 * gain, rims, &seen.middle_velocity);
    const Pair square = way * way;
    longest = std::max(longest, std::bit_cast<std::uint64_t>(square[0] + square[1]));
  }
  system.bodies.ways[block] = std::bit_cast<double>(longest);
}

template <bool turning>
auto choose_move(bool clears) {
  return clears ? by_vector_width<MoveBlock<turning, true>, GrainSystem&, std::size_t>()
                : by_vector_width<MoveBlock<turning, false>, GrainSystem&, std::size_t>();
}

}  // namespace

void move_pair_bodies(GrainSystem& system, std::size_t block) {
  const bool turning = system.friction || !system.bonds.tied.empty() || !system.shapes.parts.empty();
  const auto move = turning ? choose_move<true>(system.bodies.cleared) : choose_move<false>(system.bodies.cleared);
  move(system, block);
}

}  // namespace equidem
