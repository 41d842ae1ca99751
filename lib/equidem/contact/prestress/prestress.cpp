// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/prestress/prestress.hpp"

#include <array>
#include <cmath>

namespace equidem {
namespace {

/// With ds = t - r theta - ..., t the motion of the centres, terms of theta are ni - r ns beside dn, si - r ss beside t
/// and ii - 2 r si + r² ss beside theta.
bool turns(double lever, std::array<double, 2> beside_n, std::array<double, 2> beside_s, double theta_theta) {
  constexpr double round_off = 1e-12;
  const auto [ns, n_theta] = beside_n;
  const auto [ss, s_theta] = beside_s;
  const double along = n_theta - lever * ns, across = s_theta - lever * ss;
  const double own = theta_theta - lever * (s_theta + across), size = std::abs(s_theta) + std::abs(lever * ss);
  return std::abs(along) > round_off * (std::abs(n_theta) + std::abs(lever * ns)) ||
         std::abs(across) > round_off * size ||
         std::abs(own) > round_off * (std::abs(lever) * size + std::abs(theta_theta));
}

}  // namespace

bool turns_i(const ContactPrestress& prestress, const ContactFrame& frame) {
  return turns(frame.lever_i, {prestress.ns, prestress.ni}, {prestress.ss, prestress.si}, prestress.ii);
}

bool turns_j(const ContactPrestress& prestress, const ContactFrame& frame) {
  return turns(frame.lever_j, {prestress.ns, prestress.nj}, {prestress.ss, prestress.sj}, prestress.jj);
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
                                     const ContactForce& at_rest) {
  const double both = at_rest.normal / (curvatures.i + curvatures.j),
               slides = -at_rest.tangential / (curvatures.i + curvatures.j);
  return {.ns = slides * curvatures.i * curvatures.j,
          .ni = slides * curvatures.j,
          .nj = slides * curvatures.i,
          .ss = both * curvatures.i * curvatures.j,
          .si = both * curvatures.j,
          .sj = both * curvatures.i,
          .ii = at_rest.normal * frame.lever_i - both + at_rest.tangential * frame.offset_i,
          .ij = both,
          .jj = at_rest.normal * frame.lever_j - both + at_rest.tangential * frame.offset_j};
}

}  // namespace equidem
