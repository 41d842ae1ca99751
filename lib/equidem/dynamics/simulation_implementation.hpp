// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What a Simulation is made of; for its own sources alone.
#pragma once

#include <vector>

#include "equidem/dynamics/body_arrays.hpp"
#include "equidem/dynamics/driven_discs.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/step_kernel.hpp"

namespace equidem {

struct Simulation::Implementation {
  Scene scene;
  SimulationOptions options;
  Effects effects;
  LoopKind kind;
  StepFunction step_function = nullptr;
  std::vector<Stage> stages;
  BodyArrays bodies;
  std::vector<std::int32_t> first, neighbour;
  std::vector<double> geometry, inverse_inertia;
  LoopData data;
  DrivenDiscs driven;
  std::vector<Dissipation> dissipation;  // per strip
  std::int64_t steps = 0;
  int parity = 0;
  double initial_energy = 0, initial_potential = 0;

  Implementation(const Scene& scene_in, const SimulationOptions& options_in);

  [[nodiscard]] bool staggered() const {
    return options.integrator == Integrator::leapfrog || options.integrator == Integrator::velocity_verlet;
  }
  [[nodiscard]] double time_at(std::int64_t step) const { return static_cast<double>(step) * options.time_step; }

  void list_contacts();
  void keep_inertia();
  void start();
  void advance(std::int64_t count);
  void do_strip(std::int32_t strip, const Stage& stage, int from, double time, double time_after);
  [[nodiscard]] std::vector<DiscMotion> velocities_after(const Stage& stage, std::vector<double> motion,
                                                         std::vector<double> velocity,
                                                         std::vector<double> relative) const;
  [[nodiscard]] std::vector<DiscMotion> synchronous_velocities() const;
  [[nodiscard]] std::vector<DiscMotion> motions() const;
  [[nodiscard]] EnergyLedger ledger() const;
};

}  // namespace equidem
