// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Simulation of colliding bodies in time.
///
/// Unbalanced forces and moments, which vanish at rest.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/contact/effects.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/motion/any_simulation.hpp"

namespace equidem {

/// State of a contact in the last step. In Verlet schemes overlap and forces are those at its end.
struct GrainContact {
  std::int32_t i = 0;           ///< grain; two clumps may have several contacts
  std::int32_t j = 0;           ///< grain; negative: wall ~j
  double overlap = 0;           ///< overlap at the start of the last step, m
  double closing = 0;           ///< closing speed at the start of the last step, m/s
  Vec2 normal = {};             ///< unit, from i to j
  Vec2 arm_i = {}, arm_j = {};  ///< from the centres of mass to the contact point, m; {} for a wall
  /// Force on j along n and s, mean over the step, N: a contact pushes, so that compression is positive here.
  double normal_force = 0, tangential_force = 0;
  double moment = 0;       ///< of rolling resistance on j, N m
  int mode = 0;            ///< case of the map that was used (ContactStep::mode); 0 for other laws
  std::int64_t steps = 0;  ///< number of steps since the contact began
  bool operator==(const GrainContact&) const = default;
};

/// Counters since the start.
struct GrainCounters {
  std::int64_t evaluations = 0;  ///< evaluations of the contact law
  std::int64_t contacts = 0;     ///< contacts begun
  std::int64_t rebuilds = 0;     ///< constructions of the neighbour lists
  std::int64_t sweeps = 0;       ///< exact_flow: sweeps over all contacts
  /// exact_flow: contacts whose step is not proved stable for every arrangement of their neighbours; 0: every step was
  /// stable.
  std::int64_t doubtful = 0;
};

struct BondBreak;

class GrainSimulation final : public AnySimulation {
 public:
  /// Determines the effects and chooses the loop. Bodies and walls are sorted by position internally, so results do not
  /// depend on the caller's order.
  /// \throws Error as check(scene, options)
  GrainSimulation(const GrainScene& scene, const GrainOptions& options);

  /// Go on in a changed scene, from the present step with contacts, bonds, losses and counters. Contacts with bodies
  /// and walls that are gone end, and those of discs that are bonded now; those of bodies and walls that are new begin
  /// as at the start of a simulation; the control of servo walls that stay goes on, and their errors are counted anew.
  /// \param scene the bodies of the present one, as grains() with other kinds and presence, its bonds, then new ones,
  ///        walls at their present places; schedules are those of the time since the start; the periods of the cell are
  ///        not read
  /// \param walls the number in the present scene of each wall; -1: it is new
  /// \throws Error as the constructor; then nothing has changed
  void change(GrainScene scene, const std::vector<std::int32_t>& walls);
  /// Go on from a state of the same run in another scene, of which the places of the bodies are not read.
  /// \throws Error as restore(state) and check_properties(scene, options); then nothing has changed
  void restore(const GrainScene& scene, const SavedState& state);

  [[nodiscard]] const Effects& effects() const override;
  /// \throws Error (computation_failed) if a body would pass through a wall or another body undetected, or centres
  ///         would pass each other (the message names step, bodies, speed and a sufficient time step); if motions are
  ///         not finite; if exact_flow does not converge. The state remains that before the step.
  void advance(std::int64_t steps) override;
  [[nodiscard]] std::int64_t step() const override;
  [[nodiscard]] std::vector<DiscMotion> motions() const override;
  [[nodiscard]] std::vector<DiscMotion> velocities() const override;
  /// Contacts of the last step, then bonds (contacts_of_bonds), each ordered by (i, j).
  [[nodiscard]] std::vector<BodyContact> body_contacts() const override;
  [[nodiscard]] EnergyLedger energy() const override;
  [[nodiscard]] std::vector<WallState> walls() const override;
  [[nodiscard]] std::optional<CellState> cell() const override;
  /// The walls at their present places, without motion, in the caller's order.
  [[nodiscard]] std::vector<Wall> placed_walls() const;
  /// The periodic cell of the scene with its present periods, if there is one.
  [[nodiscard]] std::optional<PeriodicCell> placed_cell() const;
  /// One for each servo wall, in the caller's order.
  [[nodiscard]] std::vector<ServoReport> servos() const;
  [[nodiscard]] double bytes_per_body() const override;
  /// Arrays of GrainState, present bodies and walls in the order of the loops.
  [[nodiscard]] SavedState save() const override;
  void restore(const SavedState& state) override;

  /// Bodies in the caller's order; the absent ones as in the scene.
  [[nodiscard]] std::vector<Grain> grains() const;
  /// Without the absent ones.
  [[nodiscard]] std::vector<Grain> present_grains() const;
  /// Contacts of the last step, ordered by (i, j).
  [[nodiscard]] std::vector<GrainContact> contacts() const;
  [[nodiscard]] const GrainCounters& counters() const;
  /// Bonds that broke so far, in the order of time, and of the bonds at one time.
  [[nodiscard]] std::vector<BondBreak> breaks() const;
  /// Set all velocities to 0. The kinetic energy removed is counted in EnergyLedger::lost_dashpot.
  void stop_all();

 private:
  struct Implementation;
  Hidden<Implementation> implementation_;
};

/// Unbalanced loads of bodies over the mean contact force: sqrt(F² + (M/R)²), M the moment about the centre of mass, R
/// the radius of the circle about it that holds the body. Infinite without contacts.
struct Unbalance {
  double mean = 0, largest = 0;
};

/// Unbalanced loads: forces and moments of contacts and of bonds with springs, plus weights. Grains that are tied by
/// dashpots alone, which creep under any force, are one body. \param bonds of the simulation that have not broken, in
/// any order
Unbalance unbalance_of(const GrainSimulation& simulation, std::span<const GrainBond> bonds, Vec2 gravity);

}  // namespace equidem
