// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Equilibrium and effective stiffness in quadruple precision, straight from the contact law: 34 digits, of which the
/// worst case here leaves more than a double has.
#pragma once

#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/matrix.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem::test {

#ifdef __SIZEOF_FLOAT128__
__extension__ using Quad = __float128;
#else
using Quad = long double;  // quadruple where there is no other
#endif

/// Components (u_x, u_y[, a theta]) per disc, m, that balance `force` (N/m, moments over a); held ones as prescribed.
/// K is factorized as L D L^T within its envelope, discs in the order of their x; an unknown that nothing is left to
/// hold stays at zero.
std::vector<Quad> exact_motion(const Assembly& assembly, const ContactSprings& springs,
                               const DegreesOfFreedom& unknowns, const std::vector<double>& force);

/// Of a periodic cell, Pa.
Matrix3 exact_stiffness(const Assembly& assembly, const ContactSprings& springs, Rotation rotation);

}  // namespace equidem::test
