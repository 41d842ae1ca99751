// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numbers>

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"
#include "equidem/grains/kernels/vector_width.hpp"
#include "equidem/grains/neighbours/part_pairs.hpp"

namespace equidem {
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

/// Of the shaped bodies begin .. end.
template <class Lanes>
void TurnAxes::run(GrainSystem& system, std::size_t begin, std::size_t end) {
  constexpr std::size_t most = 16;
  for (std::size_t first = begin; first < end; first += most) {
    const std::size_t used = std::min(most, end - first);
    double angle[most] = {}, largest = 0;
    for (std::size_t k = 0; k < used; ++k) {
      angle[k] = system.bodies.motions[static_cast<std::size_t>(system.shapes.shaped[first + k])].angle;
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
      system.shapes.axes[static_cast<std::size_t>(system.shapes.shaped[first + k])] =
          largest < most_turns ? Vec2{x[k], y[k]} : axis_at(angle[k]);
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
