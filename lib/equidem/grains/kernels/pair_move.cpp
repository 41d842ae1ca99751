// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "equidem/core/simd.hpp"
#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/neighbours/near_pairs.hpp"

namespace equidem {
namespace {

using Pair = eight::Two;

// These members are loaded and stored as one row, here and by the loops over bonds.
static_assert(offsetof(GrainMotion, velocity) == sizeof(Vec2) &&
              offsetof(GrainMotion, angle) - offsetof(GrainMotion, spin) == sizeof(double));
static_assert(offsetof(BodyImpulse, rim) - offsetof(BodyImpulse, impulse) == 3 * sizeof(double));
static_assert(offsetof(PairBody, rim_speed) - offsetof(PairBody, middle_velocity) == 3 * sizeof(double));

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
  GrainMotion* next = system.bodies.moved ? system.bodies.motions.data() : system.bodies.next.data();
  BodyImpulse* impulses = system.bodies.impulses.data();
  PairBody* pair_bodies = system.contacts.pairs.bodies.data();
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
  const bool turning = system.friction || system.bonds.held > 0 || !system.shapes.parts.empty();
  const auto move = turning ? choose_move<true>(system.bodies.at_zero) : choose_move<false>(system.bodies.at_zero);
  move(system, block);
}

namespace {

using namespace eight;

/// Turns up to here are rounded by adding what has no digits behind the point.
constexpr double most_turns = 1e9, rounder = 6755399441055744.0;

/// sine_of_turns(), bit by bit.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes sines_of_turns(Lanes x) {
  x -= (x + rounder) - rounder;
  const Bits<Lanes> beyond = negative(0.25 - magnitude(x));
  x = choose(beyond, with_sign(all<Lanes>(0.5), x) - x, x);
  const Lanes y = (2 * std::numbers::pi) * x, square = y * y;
  Lanes sum = all<Lanes>(1);
#pragma GCC unroll 11
  for (int k = 22; k >= 2; k -= 2) sum = 1 - square * (1.0 / (k * (k + 1))) * sum;
  return y * sum;
}

/// Two eights at a time: of one alone each product would wait for the last.
struct TurnAxes {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, std::size_t begin, std::size_t end);
};

/// Turns the axes of the shaped bodies begin .. end.
template <class Lanes>
void TurnAxes::run(GrainSystem& system, std::size_t begin, std::size_t end) {
  constexpr std::size_t most = 16;
  for (std::size_t first = begin; first < end; first += most) {
    const std::size_t used = std::min(most, end - first);
    double angle[most] = {}, largest = 0;
    for (std::size_t k = 0; k < used; ++k) {
      angle[k] = system.bodies.motions[system.shapes.shaped[first + k]].angle;
      largest = std::max(largest, std::abs(angle[k]));
    }
    double x[most], y[most];
#pragma GCC unroll 2
    for (std::size_t k = 0; k < most; k += 8) {
      const Lanes turns = load<Lanes>(angle + k) / (2 * std::numbers::pi);
      store(sines_of_turns(turns + 0.25), x + k);
      store(sines_of_turns(turns), y + k);
    }
    for (std::size_t k = 0; k < used; ++k) {
      system.shapes.axes[system.shapes.shaped[first + k]] = largest < most_turns ? Vec2{x[k], y[k]} : axis_at(angle[k]);
    }
  }
}

}  // namespace

void turn_axes(GrainSystem& system) {
  const auto turn = by_vector_width<TurnAxes, GrainSystem&, std::size_t, std::size_t>();
  system.bodies.blocks.each_piece(system.shapes.shaped.size(),
                                  [&](std::size_t begin, std::size_t end) { turn(system, begin, end); });
}

}  // namespace equidem
