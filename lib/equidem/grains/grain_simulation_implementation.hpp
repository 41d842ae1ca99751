// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The parts of a GrainSimulation.
#pragma once

#include "equidem/grains/contacts/flow_step.hpp"
#include "equidem/grains/contacts/force_step.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {

struct GrainSimulation::Implementation {
  GrainSystem system;
  Effects effects;
  CollideFunction collide = nullptr;  ///< force laws and maps
  FlowFunction flow = nullptr;        ///< simultaneous laws
  double potential_at_start = 0, energy_at_start = 0;
  double bond_limit = 0;  ///< step that bonds impose, s
  SavedState kept;        ///< a state not long ago, to come back to

  void make_step();
  /// All contacts together, by a simultaneous law.
  void step_together();
  /// Semi-implicit Euler, v' = v + a(x, v) dt, x' = x + v' dt; the maps give v' in place of a.
  void step_by_euler();
  /// Half a kick, drift, impulses with the velocities of the half step, the other half of the kick.
  void step_by_verlet();
  // Their stages:
  /// Impulses of contacts and bonds, from positions and velocities as they are.
  void find_impulses();
  /// Pairs that may touch where the bodies are after the step.
  /// \throws Error (computation_failed) where bodies would pass through one another
  void update_candidates();
  /// Bodies, walls and axes are those after the step.
  void start_next_step();
  [[nodiscard]] bool verlet() const { return system.options.verlet(); }
  /// Whether a step needs the impulses of the one before.
  [[nodiscard]] bool keeps_impulses() const {
    return verlet() ||
           (collide && (system.friction || system.contacts.near.active || system.contacts.near_parts.active));
  }
  /// Of gravity, where the velocities are.
  [[nodiscard]] double potential() const;
  [[nodiscard]] double kinetic() const;
  /// Normal and tangential springs as they stand.
  [[nodiscard]] std::pair<double, double> elastic() const;
  [[nodiscard]] EnergyLedger energy() const;
};

/// Which effects a scene of colliding bodies has, and why not the others.
Effects effects_of(const GrainScene& scene, const GrainOptions& options);

}  // namespace equidem
