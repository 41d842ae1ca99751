// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The linear equations of a periodic cell under mean strains.
#pragma once

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/statics/linear_system.hpp"

namespace equidem {

/// The equations of the motions beside the unit mean strains xx, yy and xy (engineering), which effective_stiffness
/// solves for Boundary::periodic; where rotation is restrained also those beside the unit mean rotation. Discs that
/// carry no load are left out, and one component is held for each rigid motion and each group of gears. Mechanisms of a
/// few discs are not looked for: they leave K singular.
/// \throws Error (bad_input) where the assembly is not periodic, has no contacts, or nothing of it carries load
LinearSystem strain_system(const Assembly& assembly, const ContactSprings& springs,
                           Rotation rotation = Rotation::from_scene);

}  // namespace equidem
