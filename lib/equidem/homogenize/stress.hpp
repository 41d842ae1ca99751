// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Macroscopic stress from contact forces, and the contact forces of a uniform displacement gradient.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/statics/equilibrium.hpp"

namespace equidem {

/// a_ik b_kj.
constexpr Tensor2 operator*(const Tensor2& a, const Tensor2& b) {
  return {a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy, a.yx * b.xx + a.yy * b.yx, a.yx * b.xy + a.yy * b.yy};
}
constexpr Tensor2 transposed(const Tensor2& t) {
  return {t.xx, t.yx, t.xy, t.yy};
}
constexpr double determinant(const Tensor2& t) {
  return t.xx * t.yy - t.xy * t.yx;
}
constexpr Tensor2 inverse(const Tensor2& t) {
  return (1 / determinant(t)) * Tensor2{t.yy, -t.xy, -t.yx, t.xx};
}

/// Whether disc_stresses is defined: every disc has a cell of some area.
bool cells_hold_area(const Assembly& assembly);

/// Stress of every disc, Pa: s_ij = (1/V) sum F_i l_j with l = r n from its centre to each contact point and V its
/// cell area (Abe 1996, eq. 50, in general form). Not symmetric where a moment holds the disc (eq. 55); never made so
/// here.
/// \throws Error (bad_input) where the assembly has no cell areas, or a disc an empty cell
std::vector<Tensor2> disc_stresses(const Assembly& assembly, std::span<const ContactForce> forces);

/// The force on i times the branch of a contact, N: its part of the stress times the area.
Tensor2 force_by_branch(const ContactFrame& frame, const ContactForce& f);

/// Stress of the whole assembly, Pa: the average of the stresses of all discs. Where the levers of each contact add
/// up to its branch it is also the stress of the outer forces f on the discs, (1/A) sum f_i x_j.
Tensor2 macroscopic_stress(const Assembly& assembly, std::span<const ContactForce> forces);
/// That stress, and the sum of the sizes |F| |l| of its terms over the area: what its round-off is relative to.
struct ScaledStress {
  Tensor2 stress;    ///< Pa
  double scale = 0;  ///< Pa
};
ScaledStress scaled_stress(const Assembly& assembly, std::span<const ContactForce> forces);

/// Sum of the moments, N, that act on discs other than through contacts: those of restrained rotations, of supports and
/// of loads. The contact forces of a disc turn it with the moment sum l x F = V (s_yx - s_xy); at rest an outer moment
/// balances it, so that s_xy - s_yx = (outer moments, counter-clockwise) / (area). Abe 1996, section 4.3, in numbers:
/// uniform strain of the hexagonal lattice with rotation restrained gives s_xy - s_yx = -sqrt3 kT (u_2,1 - u_1,2).
double outer_moment(const Assembly& assembly, const LoadCase& loads, const Equilibrium& equilibrium);

/// The rotation of a continuum with the displacement gradient h_ij = du_i/dx_j: (h_yx - h_xy)/2, rad. Discs of the
/// hexagonal and of the square lattice that turn by it feel no moment: it is their free rotation.
constexpr double mean_rotation(const Tensor2& gradient) {
  return 0.5 * (gradient.yx - gradient.xy);
}

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
