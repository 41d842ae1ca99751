// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Choice of the loop for a scene, made once before the first step.
#pragma once

#include "equidem/dynamics/kernels/step_kernel.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// \throws Error (bad_input) if contacts lie off the lines of centres, which no loop supports
void check_contacts(const Assembly& assembly);

/// \throws Error (bad_input) as check_contacts and check(scene, rotation) of scene_check.hpp; on a mass that is not
///         positive, a damping out of range, dampings that exclude one another
void check(const Scene& scene, const SimulationOptions& options);

/// The effects of a run, with the reason for each inactive one: those of statics, then damping, gravity, loads,
/// supports, walls, large motions, unequal contacts and discs.
Effects effects_of(const Scene& scene, const SimulationOptions& options);

/// The simplest loop that contains every active effect.
LoopKind loop_for(const Scene& scene, const SimulationOptions& options, const Effects& effects);

/// Dashpots of a contact, N s/m per m: beta k, tau k, or 2 zeta sqrt(m k) with the reduced mass m.
SpringConstants dashpots_of(const Damping& damping, const SpringConstants& k, double mass_i, double mass_j);
/// The dashpot c_M beside a bending spring kM, N m s, likewise, of moments of inertia in place of masses.
double bending_dashpot_of(const Damping& damping, double kM, double moment_i, double moment_j);

}  // namespace equidem
