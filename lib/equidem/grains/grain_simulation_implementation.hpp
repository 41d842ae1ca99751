// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The parts of a GrainSimulation.
///
/// The numbers of a contact in the array `contacts` of GrainSimulation::save.
#pragma once

#include <cstddef>

#include "equidem/grains/contacts/flow_step.hpp"
#include "equidem/grains/contacts/force_step.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {

struct GrainSimulation::Implementation {
  GrainSystem system;
  Effects effects;
  CandidateLoop collide = nullptr;  ///< force laws and maps
  FlowFunction flow = nullptr;      ///< simultaneous laws
  double potential_at_start = 0, energy_at_start = 0;
  SavedState kept;  ///< a recent state, restored when a step fails

  void make_step();
  /// Step of a simultaneous law: all contacts together.
  void step_together();
  /// Semi-implicit Euler: v' = v + a(x, v) dt, x' = x + v' dt; the maps give v' directly.
  void step_by_euler();
  /// Velocity Verlet: half kick, drift, impulses from the velocities at the half step, half kick.
  void step_by_verlet();
  // Stages of both schemes:
  /// Compute the impulses of contacts and bonds from the present positions and velocities, and move the bodies by them.
  /// \param move null: none
  void find_impulses(BlockMove move);
  /// Update the pairs that may touch at the positions after the step.
  /// \throws Error (computation_failed) if bodies would pass through one another
  void update_candidates();
  /// Advance bodies, walls and axes to the end of the step.
  void start_next_step();
  [[nodiscard]] bool verlet() const { return system.options.verlet(); }
  /// Whether a step needs the impulses of the previous step.
  [[nodiscard]] bool keeps_impulses() const {
    return verlet() ||
           (collide && (system.friction || system.contacts.near.active || system.contacts.near_parts.active));
  }
  /// Potential energy of gravity at the time of the velocities, and kinetic energy, J.
  [[nodiscard]] std::pair<double, double> potential_and_kinetic() const;
  /// Energies of the normal and the tangential springs at the present positions, J.
  [[nodiscard]] std::pair<double, double> elastic() const;
  [[nodiscard]] EnergyLedger energy() const;
};

/// The effects of a scene of colliding bodies, with the reason for each inactive one.
Effects effects_of(const GrainScene& scene, const GrainOptions& options);

/// Places of numbers in a row: i, j, steps, mode, then the other members of a Candidate; in a periodic cell the periods
/// of the image; in scenes with shapes the two parts and the arms to the contact point.
struct ContactColumns {
  static constexpr std::size_t i = 0, j = 1, steps = 2, mode = 3, stretch = 4, overlap = 5, closing = 6, normal = 7,
                               impulse = 9, moment = 10, tangential_impulse = 11, parted = 12;
  std::size_t image = 13;  ///< a, b
  std::size_t part = 13;   ///< of i, of j
  std::size_t arm = 13;    ///< x and y of i, of j
  std::size_t count = 13;  ///< of all numbers

  explicit ContactColumns(const GrainSystem& system) {
    if (system.cell.active) part = arm = count = image + 2;
    if (!system.shapes.parts.empty()) arm = part + 2, count = arm + 4;
  }
};

}  // namespace equidem
