// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Data of a Simulation, for its own source files.
#pragma once

#include <vector>

#include "equidem/dynamics/driven_discs.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"
#include "equidem/dynamics/layout.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

struct Simulation::Implementation {
  Scene scene;
  SimulationOptions options;
  Effects effects;
  LoopKind kind;
  StepFunction step_function = nullptr;
  std::vector<Stage> stages;
  BodyArrays bodies;
  LaneVector<std::int32_t> first, neighbour;
  LaneVector<double> geometry, inverse_inertia;
  LoopData data;
  DrivenDiscs driven;
  std::vector<Dissipation> dissipation;  // per strip
  std::int64_t steps = 0;
  int parity = 0;
  EnergyLedger at_start;  // including sums that begin half a step before the start

  Implementation(const Scene& scene_in, const SimulationOptions& options_in);

  [[nodiscard]] bool staggered() const { return scheme_of(options.integrator).half_step_start; }
  [[nodiscard]] double time_at(std::int64_t step) const { return static_cast<double>(step) * options.time_step; }

  void list_contacts();
  void keep_inertia();
  void start();
  void advance(std::int64_t count);
  void do_strip(std::int32_t strip, const Stage& stage, int from, double time, double time_after);
  /// Velocities after a trial stage, and its contributions to the ledger.
  struct Trial {
    std::vector<DiscMotion> velocities;
    Dissipation dissipation;
    DrivingWork work;
  };
  /// \param relative velocities that dashpots read; empty without dashpots
  /// \param driven_too with supports, loads and walls
  [[nodiscard]] Trial try_stage(const Stage& stage, LaneVector<double> motion, LaneVector<double> velocity,
                                LaneVector<double> relative, bool driven_too = true) const;
  /// Half the kick of leapfrog, from the velocities half a step behind to those of now.
  [[nodiscard]] Trial half_kick() const;
  /// Forces on the discs displaced by `motions`, dampers aside; of springs and gravity alone, or of all that acts.
  [[nodiscard]] std::vector<DiscForce> forces_at(const std::vector<DiscMotion>& motions, bool driven_too) const;
  [[nodiscard]] std::vector<DiscMotion> synchronous_velocities() const;
  [[nodiscard]] std::vector<DiscMotion> motions() const;
  [[nodiscard]] double elastic_energy(const std::vector<DiscMotion>& now) const;
  void add_half_kick(const std::vector<DiscMotion>& now, EnergyLedger& ledger) const;
  [[nodiscard]] EnergyLedger raw_ledger() const;
  [[nodiscard]] EnergyLedger ledger() const;
};

}  // namespace equidem
