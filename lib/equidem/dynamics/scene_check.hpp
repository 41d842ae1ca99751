// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Check of a scene of bonded discs for contradictions.
///
/// The unknowns of a scene in statics.
#pragma once

#include <functional>
#include <string>

#include "equidem/contact/effects.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// Place of a part of a scene in the user's input, by its path such as "support.1.ux", "velocity.0.group" or "wall.2".
using PlaceInScene = std::function<std::string(const std::string& path)>;

/// No two supports give a component of a disc different motions, no disc has two initial velocities, no velocity is
/// given where a support prescribes the motion, no spin where rotations are no unknowns, and walls are as check_wall
/// says.
/// \param where for error messages; empty: the path is the place
/// \throws Error (bad_input)
void check(const Scene& scene, Rotation rotation, const PlaceInScene& where = {});

/// The unknowns left free by the supports of the scene, with the motions prescribed at the given time (s).
/// \throws Error (bad_input) as number_unknowns does
DegreesOfFreedom unknowns_at(const Scene& scene, const Effects& effects, double time);

}  // namespace equidem
