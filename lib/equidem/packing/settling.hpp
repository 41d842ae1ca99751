// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs that fall into a box and come to rest.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"
#include "equidem/material/spring_constants.hpp"

namespace equidem {

struct SettlingOptions {
  double density = 2480;    ///< of the discs, kg/m³
  SpringConstants springs;  ///< of all contacts, Pa; those with walls have the same
  /// h of the dashpots 2 h sqrt(m k), m the mass of a disc (2.27); 1 in the thesis, with shorter steps.
  double damping = 0.3;
  double gravity = 9.8;    ///< m/s², downwards
  double friction = 0.17;  ///< between discs
  double wall_friction = 0.25;
  double time_step = 0;  ///< s; 0: a quarter of the limit of stability of the lightest two discs
  double rest = 1e-6;    ///< unbalanced force ratio at which the discs are at rest
  double longest = 10;   ///< s of motion after which it is given up
  /// Bring the discs down without inertia and friction first: much faster, but the network of contacts is that of frictionless
  /// discs and denser than what falls.
  bool relax_first = false;
};

struct SettlingReport {
  double unbalanced = 0;          ///< mean unbalanced force of a disc over the mean contact force
  double largest_unbalanced = 0;  ///< of one disc, over the same
  double time_step = 0;           ///< s
  double time = 0;                ///< s of motion
  std::int64_t steps = 0;
  GrainLedger ledger;
};

/// Discs that fell into the box of a width with an open top; floor at y = 0, walls at x = 0 and x = width.
struct SettledDiscs {
  std::vector<Grain> grains;
  std::vector<GrainContact> contacts;
  SettlingReport report;
};

/// The walls of the box: 0 floor, 1 left, 2 right.
std::vector<GrainWall> walls_of_box(double width);

/// What moves: discs with the mass of their density, walls, contacts of linear springs and dashpots.
GrainScene scene_of(std::span<const Vec2> centres, std::span<const double> radii, double width,
                    const SettlingOptions& options);

/// Let go until all is at rest.
/// \throws Error (bad_input) on options out of range; (computation_failed) where no rest comes in `longest`, and as GrainSimulation
SettledDiscs settle(std::span<const Vec2> centres, std::span<const double> radii, double width,
                    const SettlingOptions& options);

/// How far the contact forces are from carrying the weights.
SettlingReport unbalance(std::span<const Grain> grains, std::span<const GrainContact> contacts, Vec2 gravity);

}  // namespace equidem
