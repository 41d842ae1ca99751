// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/prestress/prestress.hpp"

#include <cmath>

namespace equidem {
namespace {

/// With ds = t - r theta - ..., t the motion of the centres, terms of theta are si - r ss beside t and
/// ii - 2 r si + r² ss beside theta.
bool turns(double lever, double ss, double s_theta, double theta_theta) {
  constexpr double round_off = 1e-12;
  const double beside = s_theta - lever * ss, own = theta_theta - lever * (s_theta + beside);
  const double size = std::abs(s_theta) + std::abs(lever * ss);
  return std::abs(beside) > round_off * size ||
         std::abs(own) > round_off * (std::abs(lever) * size + std::abs(theta_theta));
}

}  // namespace

bool turns_i(const ContactPrestress& prestress, const ContactFrame& frame) {
  return turns(frame.lever_i, prestress.ss, prestress.si, prestress.ii);
}

bool turns_j(const ContactPrestress& prestress, const ContactFrame& frame) {
  return turns(frame.lever_j, prestress.ss, prestress.sj, prestress.jj);
}

ContactPrestress prestress_of_discs(const ContactFrame& frame, double length, const ContactForce& at_rest) {
  // With s . (u_j - u_i) = ds + r_i theta_i + r_j theta_j =: t the form is N0 t²/l - 2 T0 (r_i + r_j)/l² dn t.
  const double r_i = frame.lever_i, r_j = frame.lever_j;
  const double across = at_rest.normal / length, along = -at_rest.tangential * (r_i + r_j) / (length * length);
  return {.ns = along,
          .ni = along * r_i,
          .nj = along * r_j,
          .ss = across,
          .si = across * r_i,
          .sj = across * r_j,
          .ii = across * r_i * r_i,
          .ij = across * r_i * r_j,
          .jj = across * r_j * r_j};
}

ContactPrestress prestress_of_bodies(const ContactFrame& frame, const ContactCurvatures& curvatures,
                                     double normal_force) {
  const double both = normal_force / (curvatures.i + curvatures.j);
  return {.ss = both * curvatures.i * curvatures.j,
          .si = both * curvatures.j,
          .sj = both * curvatures.i,
          .ii = normal_force * frame.lever_i - both,
          .ij = both,
          .jj = normal_force * frame.lever_j - both};
}

}  // namespace equidem
