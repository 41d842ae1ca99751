// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contacts of all blocks of bodies in a step, and their motion.
#pragma once

#include <array>
#include <cstddef>

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Add the impulses of all candidates, and what they add to sums.
using CandidateLoop = void (*)(GrainSystem& system, BlockSums& sums);

/// Advance the bodies of a block by their impulses.
using BlockMove = void (*)(GrainSystem& system, std::size_t block);

/// Set the impulses of all bodies to those of their contacts in this step, and count their sums.
/// \param loop of a map; null: force laws
/// \param move of each block, made as soon as its impulses are known, while they are in the cache; null: none, or a map
void collide_bodies(GrainSystem& system, CandidateLoop loop, BlockMove move);

/// \param gain,turn change of velocity and of spin by the contacts in the last step
inline PairBody pair_body(const GrainBody& body, const GrainMotion& motion, Vec2 gain, double turn) {
  return {motion.position, motion.velocity, motion.velocity + 0.5 * gain, (motion.spin + 0.5 * turn) * body.radius,
          motion.spin * body.radius};
}

/// Add the torque of the tangential impulses of near pairs.
inline void turn_rims(BodyImpulse& push, const GrainBody& body) {
  push.torque += body.radius * push.rim;
  push.rim = 0;
}

/// Set system.longest_way to the largest of system.bodies.ways.
void take_longest_way(GrainSystem& system);

/// Set system.longest_way to the largest of way_of(block), the squares of the longest displacements of blocks, m².
template <class Way>
void find_longest_way(GrainSystem& system, const Way& way_of) {
  system.bodies.blocks.each([&](std::size_t block) { system.bodies.ways[block] = way_of(block); });
  take_longest_way(system);
}

/// Set system.bodies.next[i] = motion(i), the motion after the step, for the bodies of a block.
/// \return square of the longest displacement, m²
template <class Motion>
double move_block(GrainSystem& system, std::size_t block, const Motion& motion) {
  const GrainMotion* before = system.bodies.motions.data();
  GrainMotion* after = system.bodies.next.data();
  const auto move = [&](std::size_t i, double& longest) {
    after[i] = motion(i);
    const Vec2 way = after[i].position - before[i].position;
    const double square = dot(way, way);
    longest = square > longest || square != square ? square : longest;  // a NaN persists: no number compares as larger
  };
  constexpr std::size_t lanes = 4;  // independent maxima, so that comparisons do not wait for one another
  std::array<double, lanes> longest{};
  const std::size_t begin = system.bodies.blocks.begin(block), end = system.bodies.blocks.end(block);
  const std::size_t whole = end - (end - begin) % lanes;
  for (std::size_t i = begin; i < whole; i += lanes) {
    for (std::size_t k = 0; k < lanes; ++k) move(i + k, longest[k]);
  }
  for (std::size_t i = whole; i < end; ++i) move(i, longest[0]);
  for (std::size_t k = 1; k < lanes; ++k) {
    if (longest[k] > longest[0] || longest[k] != longest[k]) longest[0] = longest[k];
  }
  return longest[0];
}

/// As move_block for all blocks; sets system.longest_way, too.
template <class Motion>
void move_bodies(GrainSystem& system, const Motion& motion) {
  find_longest_way(system, [&](std::size_t block) { return move_block(system, block, motion); });
}

}  // namespace equidem
