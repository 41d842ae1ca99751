// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contact forces where every disc follows a uniform displacement gradient.
#pragma once

#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// The rotation of a continuum with the displacement gradient h_ij = du_i/dx_j: (h_yx - h_xy)/2, rad. Discs of the
/// hexagonal and of the square lattice that turn by it feel no moment: it is their free rotation.
constexpr double mean_rotation(const Tensor2& gradient) {
  return 0.5 * (gradient.yx - gradient.xy);
}

/// Stretch and slip, m, of every contact under the affine motion u = h x, all discs turning by `rotation`
/// (rad).
std::vector<ContactDeformation> affine_deformations(const Assembly& assembly, const Tensor2& gradient, double rotation);

/// Contact forces, N/m, under the affine motion u = h x, all discs turning by the same `rotation`
/// (rad):
///
///   dn = n . h l,   ds = s . h l - (r_i + r_j) rotation,   l the branch vector
///
/// (off the line of centres dn has the term (o_i + o_j) rotation of the offsets too).
///
/// With rotation = 0 these are the forces of Abe 1996, eq. (54). On a lattice with one disc in its primitive cell
/// they balance on every disc; elsewhere they do not, and their energy is the Voigt bound.
std::vector<ContactForce> affine_contact_forces(const Assembly& assembly, const ContactSprings& springs,
                                                const Tensor2& gradient, double rotation);

}  // namespace equidem
