// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The parts of a GrainSimulation, and what it goes on from.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/contacts/force_step.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Potential energy of gravity, and kinetic energy with that of the springs, J.
struct EnergyAtStart {
  double potential = 0, energy = 0;
};

/// Bodies, bonds, walls and parts in the order of the loops.
struct GrainState {
  std::int64_t step = 0;
  std::vector<GrainMotion> motions = {};
  std::vector<ContactState> contacts = {};
  std::vector<BodyImpulse> impulses = {};  ///< of the last step, if the next step needs them
  std::vector<BondState> bonds = {};       ///< of all, broken ones too
  std::vector<BondBreak> breaks = {};
  EnergyLedger lost = {};
  GrainCounters counters = {};
  std::vector<WallLoad> walls = {};
  std::vector<ServoMotion> servos = {};
  EnergyAtStart start = {};
  CellMotion cell = {};
  std::vector<PeriodicImage> crossed = {};  ///< as MovingCell::crossed
};

struct GrainSimulation::Implementation {
  GrainSystem system;
  Effects effects;
  CandidateLoop collide = nullptr;  ///< maps
  FlowFunction flow = nullptr;      ///< simultaneous laws
  EnergyAtStart at_start;
  std::optional<GrainState> kept;  ///< a recent state, restored when a step fails

  /// \param scene checked
  /// \param before an earlier scene of the run, from which the order of the bodies and the centre of the cell are
  Implementation(const GrainScene& scene, const GrainOptions& options, const GrainSystem* before = nullptr);

  /// Begin the contacts of bodies that overlap.
  void begin();
  /// Go on from another simulation, as GrainSimulation::change.
  void take_over(const Implementation& before, const std::vector<std::int32_t>& walls);

  [[nodiscard]] GrainState state() const;
  void go_back_to(const GrainState& state);
  void restore(const SavedState& saved);

  void make_step();
  /// Step of a simultaneous law: all contacts together.
  void step_together();
  /// Semi-implicit Euler: v' = v + a(x, v) dt, x' = x + v' dt; the maps give v' directly.
  void step_by_euler();
  /// Velocity Verlet: half kick, drift, impulses from the velocities at the half step, half kick.
  void step_by_verlet();
  [[nodiscard]] bool verlet() const { return system.options.verlet(); }
  /// Whether a step needs the impulses of the previous step.
  [[nodiscard]] bool keeps_impulses() const { return gives_force(system.options.law) || (collide && system.friction); }
  /// Potential energy of gravity at the time of the velocities, and kinetic energy, J.
  [[nodiscard]] std::pair<double, double> potential_and_kinetic() const;
  [[nodiscard]] EnergyLedger energy() const;
  [[nodiscard]] std::vector<GrainContact> contacts() const;
};

/// Compute the impulses of contacts and bonds from the present positions and velocities.
/// \param collide the loop of a map; null: force laws
/// \param move of the bodies of a block by them; null: none
void find_impulses(GrainSystem& system, CandidateLoop collide, BlockMove move);

/// The effects of a scene of colliding bodies, with the reason for each inactive one.
Effects effects_of(const GrainScene& scene, const GrainOptions& options);

}  // namespace equidem
