// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Springs of other sizes at the same contacts: what depends on the network alone, and what on the sizes.
#pragma once

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"

namespace equidem {

/// Every spring replaced by one of 1 Pa: the zero-energy modes stay, but no longer how little energy others
/// cost.
ContactSprings equal_springs(const Assembly& assembly, const ContactSprings& springs);

/// All springs times a factor.
ContactSprings scaled_springs(const Assembly& assembly, const ContactSprings& springs, double factor);

/// The power of two at or below the largest spring, Pa, or 1: dividing by it rounds nothing.
double spring_unit(const ContactSprings& springs);

/// The stiffest spring over the softest that there is, by magnitude.
double spring_spread(const Assembly& assembly, const ContactSprings& springs);

/// Refuse springs so far apart that the softest leaves too few digits of a double beside the stiffest.
/// \throws Error (bad_input) with their ratio
[[noreturn]] void refuse_spread(double spread);

}  // namespace equidem
