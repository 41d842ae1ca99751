// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Integrators as sequences of stages, with their order and stability limit.
#pragma once

#include <string>
#include <vector>

#include "equidem/dynamics/kernels/step_kernel.hpp"

namespace equidem {

enum class Integrator {
  leapfrog,         ///< central differences: velocities half a step behind; order 2
  velocity_verlet,  ///< the same motion, velocities at full steps; order 2
  thesis,           ///< Sukegawa (3.14)-(3.17) as printed: x' = x + (v + v')/2 dt; order 1, unstable without damping
  fourth_order,     ///< Forest & Ruth's composition with the coefficients of Omelyan et al. (2002), symplectic; order 4
};

/// "leapfrog" | "velocity_verlet" | "thesis" | "fourth_order".
/// \throws Error (bad_input) naming the choices
Integrator integrator_from(const std::string& name);
std::string to_string(Integrator integrator);

struct IntegratorFacts {
  int order = 2;                ///< where forces depend on positions, and for mass-proportional damping
  int force_evaluations = 1;    ///< per step
  bool velocities_lag = false;  ///< by half a step
};
IntegratorFacts facts_of(Integrator integrator);
/// With forces that depend on velocities, of dashpots at contacts and of local damping: all schemes take them from
/// before the step, half a step late at least.
constexpr int order_with_late_velocities = 1;

/// Largest stable omega dt of an oscillator u'' + 2 zeta omega u' + omega² u = 0. Mass-proportional damping of leapfrog
/// is central and leaves its limit of 2; a contact dashpot (zeta > 0 from relative velocities) is evaluated half a step
/// behind: 2 (sqrt(1 + zeta²)
/// - zeta). The thesis's scheme: min(4 zeta, 1/zeta). 0: never stable.
/// \param zeta damping ratio of the dashpots at contacts (thesis: all damping)
double stability_limit(Integrator integrator, double zeta);

/// Stages of one step, motion by motion; keep, kick and drift as of step_kernel.hpp.
/// \param mass_damping alpha, 1/s: acceleration -alpha v
std::vector<Stage> stages_of(Integrator integrator, double time_step, double mass_damping);

/// The time, s, by which motions are kept ahead between steps: the fourth-order scheme begins and ends a step with the
/// same short drift, and two of them are one.
double first_drift(Integrator integrator, double time_step);

}  // namespace equidem
