// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that meet, rebound and part, stepped in time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "equidem/contact/effects.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/motion/any_simulation.hpp"

namespace equidem {

/// A contact as it was in the last step.
struct GrainContact {
  std::int32_t i = 0;                             ///< grain; clumps may meet in several contacts
  std::int32_t j = 0;                             ///< grain, or ~j a wall (negative)
  double overlap = 0;                             ///< at the beginning of the last step, m
  double closing = 0;                             ///< then, m/s
  Vec2 normal;                                    ///< unit, from i to j
  Vec2 arm_i, arm_j;                              ///< from the centres of mass to the contact point, m; of a wall {}
  double normal_force = 0, tangential_force = 0;  ///< mean over the step
  int mode = 0;                                   ///< of the maps
  std::int64_t steps = 0;                         ///< it has lasted
  bool operator==(const GrainContact&) const = default;
};

/// What was done since the start.
struct GrainCounters {
  std::int64_t evaluations = 0;  ///< of the contact law
  std::int64_t contacts = 0;     ///< begun
  std::int64_t rebuilds = 0;     ///< of the neighbour lists
  std::int64_t sweeps = 0;       ///< exact_flow: over all contacts
  /// exact_flow: contacts in a step that is not stable for every arrangement of their neighbours; where it is 0 none
  /// was.
  std::int64_t doubtful = 0;
};

/// How far a bond has given way since the start.
struct BondDrift {
  std::size_t i = 0, j = 0;  ///< grains
  double distance = 0;       ///< of the centres, over the sum of the radii
  double slip = 0;           ///< of the surfaces at the point of the bond, over the same: whole turns are not counted
  double roll = 0;           ///< of j against i, rad
};

/// The same of all bonds.
struct BondReport {
  struct Drift {
    double largest = 0, mean = 0;  ///< over the bonds, of absolute values
  };
  std::size_t number = 0;
  Drift distance, slip, roll;  ///< as in BondDrift
  double step_limit = 0;       ///< s, that the bonds impose; infinite: none
};

class GrainSimulation final : public AnySimulation {
 public:
  /// Decide the effects, pick the loop. Bodies and walls are kept in an order of their own, by place, so that the
  /// caller's order changes no bit.
  /// \throws Error as check(scene, options)
  GrainSimulation(const GrainScene& scene, const GrainOptions& options);
  ~GrainSimulation() override;
  GrainSimulation(GrainSimulation&&) noexcept;
  GrainSimulation& operator=(GrainSimulation&&) noexcept;
  GrainSimulation(const GrainSimulation&) = delete;
  GrainSimulation& operator=(const GrainSimulation&) = delete;

  [[nodiscard]] BodyFamily family() const override { return BodyFamily::colliding; }
  [[nodiscard]] const Effects& effects() const override;
  /// \throws Error (computation_failed) before the step in which a body would pass through a wall or another body
  ///         unseen, or centres would pass each other; naming step, bodies, speed and the step that would do; on
  ///         motions that are no numbers; where exact_flow finds no common solution of all contacts. The state is that
  ///         before the step.
  void advance(std::int64_t steps) override;
  [[nodiscard]] std::int64_t step() const override;
  [[nodiscard]] double time() const override;
  [[nodiscard]] std::vector<DiscMotion> motions() const override;
  [[nodiscard]] std::vector<DiscMotion> velocities() const override;
  [[nodiscard]] EnergyLedger energy() const override;
  [[nodiscard]] double bytes_per_body() const override;
  /// Arrays: motions (n, 3): position, angle; velocities (n, 3): velocity, spin; contacts as the loop keeps them;
  /// impulses (n, 3) of the last step and bonds (b, 3), where the next step needs them; losses: the terms of the
  /// ledger; counters.
  [[nodiscard]] SavedState save() const override;
  void restore(const SavedState& state) override;

  /// In the caller's order.
  [[nodiscard]] std::vector<Grain> grains() const;
  /// Of the last step, in the order of (i, j).
  [[nodiscard]] std::vector<GrainContact> contacts() const;
  [[nodiscard]] const GrainCounters& counters() const;
  [[nodiscard]] BondReport bonds() const;
  /// In the order of (i, j), i < j.
  [[nodiscard]] std::vector<BondDrift> bond_drifts() const;
  /// Set all velocities to 0; the energy taken counts as lost in normal dashpots.
  void stop_all();

 private:
  void go_back_to(const SavedState& state);

  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace equidem
