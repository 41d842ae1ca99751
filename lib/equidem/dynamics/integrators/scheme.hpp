// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// An integrator as a sequence of stages, with its order and its limit of stability.
///
/// An integrator is one file of this folder that defines a constant of type IntegrationScheme, and its name in the list
/// of integrator.hpp.
#pragma once

#include <vector>

#include "equidem/dynamics/kernels/step_kernel.hpp"

namespace equidem {

/// Method to find the longest stable step.
enum class StabilityLimit {
  central_differences,  ///< with all damping, from the energy of the highest mode and its dashpots
  thesis,               ///< with all damping, for the scheme of Sukegawa (2010)
  undamped,             ///< stability_limit(0) over the highest frequency
};

/// Effect of mass-proportional damping, an acceleration -alpha v, over a step h.
enum class MassDamping {
  central,    ///< factor (1 - alpha h/2)/(1 + alpha h/2)
  one_sided,  ///< factor 1 - alpha h
  exact,      ///< exp(-alpha h), exact under a constant force
};

struct IntegrationScheme {
  int order = 2;                 ///< where forces depend on positions, and for mass-proportional damping
  int force_evaluations = 1;     ///< per step
  bool velocities_lag = false;   ///< velocities lag by half a step
  bool half_step_start = false;  ///< initial half kick before the first step
  bool takes_dashpots = true;    ///< forces may depend on velocities
  StabilityLimit limit = StabilityLimit::undamped;
  MassDamping mass_damping = MassDamping::central;
  /// Largest stable omega dt of the oscillator u'' + 2 zeta omega u' + omega² u = 0; 0: never stable.
  double (*stability_limit)(double zeta);
  /// Stages of one step, motion by motion; keep, kick and drift as in step_kernel.hpp.
  /// \param h time step, s
  /// \param alpha mass-proportional damping, 1/s
  std::vector<Stage> (*stages)(double h, double alpha);
  double first_drift = 0;  ///< time by which motions are stored ahead between steps, in time steps
};

}  // namespace equidem
