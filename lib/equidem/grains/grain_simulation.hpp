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

namespace equidem {

/// Energies, J (spheres) or J per metre of depth. Maps and exact_flow keep all to one instant; the force laws by Euler
/// keep velocities half a step behind, and the potential of gravity is taken where the body was then.
struct GrainLedger {
  double kinetic = 0;
  double elastic_normal = 0, elastic_tangential = 0;
  double elastic_bond = 0;      ///< springs of bonds
  double potential = 0;         ///< gravity, 0 at the start
  double lost_restitution = 0;  ///< maps
  double lost_dashpot = 0;      ///< normal
  double lost_slip = 0, lost_tangential_dashpot = 0;
  double lost_release =
      0;  ///< tangential springs, and normal springs of contacts that end at zero force, let go at the end of a contact
  double lost_bond = 0;  ///< dashpots of bonds
  double work_of_walls = 0;
  double initial = 0;  ///< kinetic + elastic at the start
  [[nodiscard]] double lost() const {
    return lost_restitution + lost_dashpot + lost_slip + lost_tangential_dashpot + lost_release + lost_bond;
  }
  [[nodiscard]] double elastic() const { return elastic_normal + elastic_tangential + elastic_bond; }
  /// What the balance lacks: kinetic + elastic + potential + lost - work - initial.
  [[nodiscard]] double error() const { return kinetic + elastic() + potential + lost() - work_of_walls - initial; }
};

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

/// Everything needed to go on with the same bits, in the caller's order.
struct GrainState {
  std::int64_t step = 0;
  std::vector<Grain> grains;
  std::vector<double> contacts;  ///< as the loop keeps them
  GrainLedger ledger;
  std::vector<double> sums;  ///< pushes of the last step, where the next needs them
  GrainCounters counters;
};

class GrainSimulation {
 public:
  /// Decide the effects, pick the loop. Bodies and walls are kept in an order of their own, by place, so that the
  /// caller's order changes no bit.
  /// \throws Error as check(scene, options)
  GrainSimulation(const GrainScene& scene, const GrainOptions& options);
  ~GrainSimulation();
  GrainSimulation(GrainSimulation&&) noexcept;
  GrainSimulation& operator=(GrainSimulation&&) noexcept;
  GrainSimulation(const GrainSimulation&) = delete;
  GrainSimulation& operator=(const GrainSimulation&) = delete;

  /// Make steps.
  /// \throws Error (computation_failed) before the step in which a body would pass through a wall or another body
  ///         unseen, or centres
  ///         would pass each other; naming step, bodies, speed and the step that would do; on motions that are no
  ///         numbers; where exact_flow finds no common solution of all contacts. The state is that before the step.
  void advance(std::int64_t steps);

  [[nodiscard]] std::int64_t step() const;
  [[nodiscard]] double time() const;
  /// In the caller's order.
  [[nodiscard]] std::vector<Grain> grains() const;
  /// Of the last step, in the order of (i, j).
  [[nodiscard]] std::vector<GrainContact> contacts() const;
  [[nodiscard]] GrainLedger energy() const;
  [[nodiscard]] const GrainCounters& counters() const;
  [[nodiscard]] BondReport bonds() const;
  /// In the order of (i, j), i < j.
  [[nodiscard]] std::vector<BondDrift> bond_drifts() const;
  [[nodiscard]] const Effects& effects() const;
  /// Bytes of all arrays, per grain.
  [[nodiscard]] double bytes_per_grain() const;

  [[nodiscard]] GrainState save() const;
  /// \throws Error (bad_input) where the state is of another number of bodies
  void restore(const GrainState& state);

 private:
  void go_back_to(const GrainState& state);

  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace equidem
