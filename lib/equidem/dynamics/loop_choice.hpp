// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Which loop a scene needs: decided once, before the first step.
#pragma once

#include "equidem/dynamics/kernels/step_kernel.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// \throws Error (bad_input) where contacts lie off the lines of centres: no loop knows of them
void check_contacts(const Assembly& assembly);

/// \throws Error (bad_input) as check_contacts, where a mass is not positive, a damping is out of range, or several
///         exclude one another
void check(const Scene& scene, const SimulationOptions& options);

/// What is active in a run, and why each other effect is not: those of statics, then damping, gravity, loads, supports,
/// walls, large motions, unequal contacts and discs.
Effects effects_of(const Scene& scene, const SimulationOptions& options);

/// The plainest loop that still holds everything that can change the answer.
LoopKind loop_for(const Scene& scene, const SimulationOptions& options, const Effects& effects);

/// Dashpots of a contact, N s/m per m: beta k, or 2 zeta sqrt(m k) with the reduced mass m.
SpringConstants dashpots_of(const Damping& damping, const SpringConstants& k, double mass_i, double mass_j);

}  // namespace equidem
