// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The geometric stiffness of a contact: what the force that it carries at rest adds to the tangent as the contact
/// turns.
///
/// A contact carries N0 (tension positive) and T0 on i along n and s. Under motions of any size the work that it stores
/// is W(dn, ds) with dW = N d(dn) + T d(ds); its second derivative is that of the springs plus
///
///   N0 d²(dn) + T0 d²(ds).
///
/// d²(dn) is the curvature of the gap of two smooth bodies. To second order in their motion these are the discs that
/// touch them: with kappa the curvature of a surface at the contact (the inverse of the distance from the contact point
/// to its centre of curvature) and r the levers,
///
///   d²(dn) = (kappa_i kappa_j ds² + 2 ds (kappa_j theta_i + kappa_i theta_j) - (theta_i - theta_j)²)
///            / (kappa_i + kappa_j) + r_i theta_i² + r_j theta_j².
///
/// For discs about their centres, kappa = 1/r and l = r_i + r_j, it is (s . (u_j - u_i))²/l: no rotation enters. A wall
/// has kappa = 0.
///
/// The slip of two outlines that stay in contact is the difference of the arcs that the contact point has gone along
/// them, a function of the place of the bodies alone. Its second derivative has the curvatures and not their change
/// along the outlines, and the offsets o of the contact point:
///
///   d²(ds) = -2 dn (kappa_i kappa_j ds + kappa_j theta_i + kappa_i theta_j)/(kappa_i + kappa_j)
///            + o_i theta_i² + o_j theta_j²,
///
/// for discs -2/l (n . (u_j - u_i)) (s . (u_j - u_i)), that of finite_bond.hpp. It holds where bodies touch, and for
/// arcs of circles at any overlap; elsewhere the change of curvature within the overlap is left out. Both are
/// derivatives of a potential: K stays symmetric.
///
/// Colliding bodies (grains) have the same normal force; their tangential force follows the slip without a potential,
/// dT = kT (v . s) dt. Its derivative is the same for motions that keep the overlap, dn = 0; with dn it differs by
/// terms of T0/l, beside kN and kT an amount of the order of the overlap over the radius.
#pragma once

#include "equidem/contact/frame.hpp"

namespace equidem {

/// The symmetric form of a contact in (dn, ds, theta_i, theta_j) that is added to kN dn² + kT ds², in N. The entry nn
/// is 0.
struct ContactPrestress {
  double ns = 0, ni = 0, nj = 0;  ///< Pa, N/m, N/m
  double ss = 0, si = 0, sj = 0;  ///< Pa, N/m, N/m
  double ii = 0, ij = 0, jj = 0;  ///< N
};

/// True where the form changes as body i, or j, turns about its centre: that of discs about their centres does not.
bool turns_i(const ContactPrestress& prestress, const ContactFrame& frame);
bool turns_j(const ContactPrestress& prestress, const ContactFrame& frame);

/// Curvatures of both surfaces at a contact, 1/m; 0: flat.
struct ContactCurvatures {
  double i = 0, j = 0;
};

/// The form of two discs about their centres, which are `length` (m) apart.
ContactPrestress prestress_of_discs(const ContactFrame& frame, double length, const ContactForce& at_rest);

/// The form of two smooth bodies. Precondition: the curvatures are not negative, and not both 0.
ContactPrestress prestress_of_bodies(const ContactFrame& frame, const ContactCurvatures& curvatures,
                                     const ContactForce& at_rest);

/// The change of the force of a contact, and what turns the bodies beside the moments of that force, N.
template <typename Number>
struct ContactResponse {
  ForceOf<Number> force;
  Number moment_i = 0, moment_j = 0;
};

/// Adds the forces and moments of the form to those of the springs.
template <typename Number>
void add_prestress(const ContactPrestress& g, const DeformationOf<Number>& d, Number theta_i, Number theta_j,
                   ContactResponse<Number>& response) {
  response.force.normal += g.ns * d.tangential + g.ni * theta_i + g.nj * theta_j;
  response.force.tangential += g.ns * d.normal + g.ss * d.tangential + g.si * theta_i + g.sj * theta_j;
  response.moment_i -= g.ni * d.normal + g.si * d.tangential + g.ii * theta_i + g.ij * theta_j;
  response.moment_j -= g.nj * d.normal + g.sj * d.tangential + g.ij * theta_i + g.jj * theta_j;
}

/// The form of two deformations a and b: a . G b, N.
template <typename Number>
Number prestress_form(const ContactPrestress& g, const DeformationOf<Number>& a, Number a_i, Number a_j,
                      const DeformationOf<Number>& b, Number b_i, Number b_j) {
  ContactResponse<Number> of_b;
  add_prestress(g, b, b_i, b_j, of_b);
  return of_b.force.normal * a.normal + of_b.force.tangential * a.tangential - of_b.moment_i * a_i -
         of_b.moment_j * a_j;
}

}  // namespace equidem
