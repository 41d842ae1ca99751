// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that fall into a box and come to rest.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

struct SettlingOptions {
  double density = 2480;    ///< of the bodies, kg/m³
  SpringConstants springs;  ///< of all contacts, Pa; those with walls have the same
  /// h of the dashpots 2 h sqrt(m k), m the mass of a body (2.27); 1 in the thesis, with shorter steps.
  double damping = 0.3;
  double gravity = 9.8;    ///< m/s², downwards
  double friction = 0.17;  ///< between bodies
  double wall_friction = 0.25;
  double time_step = 0;  ///< s; 0: a quarter of the limit of stability of the two lightest bodies
  double rest = 1e-6;    ///< unbalanced force ratio at which the bodies are at rest
  double longest = 10;   ///< s of motion after which it is given up
  /// Dashpots of bonded pairs, as shares of the stability limit of a step with the velocities at its start: C_n = share
  /// 2 m_n/dt, C_s = share 2 m_s/dt with m_n = m/2, m_s = m/6. What they carry makes them creep, the less the larger
  /// they are: far more than the limit of an explicit step, or the bodies never come to rest.
  double bond_share = 2e4;
};

struct SettlingReport {
  double unbalanced = 0;          ///< mean unbalanced force of a body over the mean contact force
  double largest_unbalanced = 0;  ///< of one body, over the same
  double time_step = 0;           ///< s
  double time = 0;                ///< s of motion
  std::int64_t steps = 0;
  EnergyLedger ledger = {};
};

/// The walls of the box: 0 floor, 1 left, 2 right.
std::vector<Wall> walls_of_box(double width);

/// A box of a width with an open top, floor at y = 0, walls at x = 0 and x = width: walls, gravity, contacts of linear
/// springs and dashpots. Bodies are of kind 0 and still to come.
GrainScene scene_of_box(double width, const SettlingOptions& options);

/// Stability limit, s, of a contact of the two lightest bodies of a scene in semi-implicit Euler, with the longest
/// lever of its forces. Several contacts of a body lower it.
double contact_step_limit(const GrainScene& scene, const SettlingOptions& options);

/// The step in which bodies fall, s: that of the options, or a quarter of the limit of one contact, since several at a
/// body lower it, and dashpots in proportion to their number.
double settling_step(const GrainScene& scene, const SettlingOptions& options);

}  // namespace equidem
