// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rest found by moving the discs: what a matrix finds for small motions, and what no single matrix can for finite
/// ones.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "equidem/dynamics/simulation.hpp"

namespace equidem {

struct RelaxationOptions {
  LoopKind::Motion motion = LoopKind::Motion::small;
  Rotation rotation = Rotation::from_scene;
  Vec2 gravity = {};  ///< m/s²
  double time = 0;    ///< s, at which supports, loads and walls stand still
  /// Of the relative unbalanced force, > 0. Rounding allows about 1e-13 of a block, 1e-11 of a slender strip.
  double tolerance = 1e-10;
  std::int64_t max_steps = 1000000;    ///< > 0
  std::vector<DiscMotion> start = {};  ///< where to begin, one per disc; empty: the reference state
};

struct Relaxation {
  std::vector<DiscMotion> motions;  ///< per disc
  double relative_unbalanced = 0;
  std::int64_t steps = 0;        ///< of the method
  std::int64_t evaluations = 0;  ///< of the forces of all contacts, each the work of a step in time
  double seconds = 0;
  /// One line for people.
  [[nodiscard]] std::string report() const;
};

/// Move the discs to rest, with the forces of the loop that steps them in time.
///
/// Conjugate gradients with fictitious masses: of damped motion u' = u + h v', v' = keep v + kick M^-1 f(u) they are
/// the one whose two coefficients are chosen anew in each step, by the forces themselves. The inertia of the scene does
/// not matter at rest; every component gets as mass the sum of its row of K, entries taken positive (Gershgorin), so
/// that local frequencies are alike whatever the spread of springs and radii. For finite motions and walls: Polak and
/// Ribière's variant with a step length from a secant, no disc moving further than a fifth of the mean radius at a
/// time.
///
/// Why not damping that is adapted to the slowest motion (dynamic relaxation, Underwood 1983), which needs no sums over
/// discs: both take steps in proportion to the root of the condition of M^-1 K, but blocks in tension have one mode far
/// below the others (the one that bends the point support), which conjugate gradients are done with early. Measured to
/// a relative error of 1e-10 in displacements, 41 x 41 discs: 400 evaluations of forces against 3500.
/// \throws Error (bad_input) on options out of range and as Simulation does; Error (computation_failed) where no rest
///         is found, or
///         the state is no minimum of the energy (kT < 0 with free rotation)
Relaxation relax(const Scene& scene, const RelaxationOptions& options = {});

/// 2-norm of the unbalanced forces, moments over the mean radius, over that of them and the forces of contacts and
/// walls
/// together: 0 where nothing is unbalanced, 1 where nothing carries a force.
/// \param time s, at which walls stand where they do
double relative_unbalanced_force(const Scene& scene, LoopKind::Motion motion, const std::vector<DiscForce>& unbalanced,
                                 const std::vector<DiscMotion>& motions, double time = 0);

}  // namespace equidem
