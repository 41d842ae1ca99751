// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The unknowns of a scene as statics counts them.
#pragma once

#include "equidem/contact/effects.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// What the supports of the scene leave free, with the motions that they prescribe at that time (s).
/// \throws Error (bad_input) as number_unknowns does
DegreesOfFreedom unknowns_at(const Scene& scene, const Effects& effects, double time);

}  // namespace equidem
