// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Effective stiffness of a periodic cell, or of a sample whose boundary is displaced.
#pragma once

#include "equidem/homogenize/effective_stiffness.hpp"

namespace equidem {

/// Unit mean strains, and the unit mean rotation where discs cannot turn. Fills the stiffness, its parts, the
/// unsymmetric tensor, the fluctuations and the error bound (without rounding) of `result`.
/// \throws Error as effective_stiffness
void solve_strains(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
                   EffectiveStiffness& result);

}  // namespace equidem
