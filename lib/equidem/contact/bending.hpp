// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bending springs of bonds: the moment that a bond of some width carries.
#pragma once

#include <optional>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"

namespace equidem {

/// One of the two, or none: contacts carry no moments.
struct BendingOptions {
  std::optional<double> kM = {};          ///< >= 0, N m/rad per metre of depth, of every contact
  std::optional<double> bond_width = {};  ///< >= 0: width w of a bond over the diameter of its smaller disc

  [[nodiscard]] bool given() const { return kM || bond_width; }
};

/// Width of the bond of a contact, m; 0 where none is given.
double bond_width(const Assembly& assembly, std::size_t contact, const BendingOptions& options);

/// The springs with the bending springs of the bonds: kM as given, or that of a parallel bond, an elastic layer whose
/// stiffness kN/w per length is spread evenly over its width w: kM = (kN/w) w³/12 = kN w²/12, kN that of the contact
/// (Potyondy & Cundall 2004, Int. J. Rock Mech. Min. Sci. 41, 1329: a rectangle in two dimensions).
/// \throws Error (bad_input) where both are given, a number is negative or not finite, some kT < 0, or kM is more than
///         1e10 times kN r², r the radius of the smaller disc
ContactSprings bending_springs(const Assembly& assembly, const ContactSprings& springs, const BendingOptions& options);

}  // namespace equidem
