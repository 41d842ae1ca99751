// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The unknowns of a scene in statics.
#pragma once

#include "equidem/contact/effects.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// The unknowns left free by the supports of the scene, with the motions prescribed at the given time (s).
/// \throws Error (bad_input) as number_unknowns does
DegreesOfFreedom unknowns_at(const Scene& scene, const Effects& effects, double time);

}  // namespace equidem
