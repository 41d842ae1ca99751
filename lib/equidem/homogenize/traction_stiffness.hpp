// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Effective stiffness of a sample under uniform tractions.
#pragma once

#include "equidem/homogenize/effective_stiffness.hpp"

namespace equidem {

/// The compliance of a sample whose boundary carries the tractions of unit stresses, inverted: see TractionSample.
/// Fills the stiffness, its parts and the error bound (without rounding) of `result`.
/// \throws Error as effective_stiffness
void solve_tractions(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
                     EffectiveStiffness& result);

}  // namespace equidem
