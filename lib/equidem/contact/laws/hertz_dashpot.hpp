// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Hertz spring and dashpot: F = k d^(3/2) + c d^(1/4) v, c = alpha sqrt(m k) (Tanaka, Ishida & Tsuji 1991; the law T
/// of Fujioka & Ushijima 2005).
///
/// Velocity against d^(5/4) is that of a linear spring and dashpot with zeta = alpha/sqrt(5): the restitution does not
/// depend on the speed, and is exact for either end of the contact.
#pragma once

#include <cmath>

#include "equidem/contact/laws/law.hpp"

namespace equidem::laws {

struct HertzDashpot {
  static constexpr const char* name = "hertz_dashpot";
  static constexpr const char* letter = "T";
  static constexpr const char* source = "Tanaka, Ishida & Tsuji 1991";
  static constexpr const char* summary = "Hertz spring and dashpot";
  static constexpr LawKind kind = LawKind::force;
  static constexpr bool has_dashpot = true;
  static constexpr ContactEnd usual_end = ContactEnd::at_zero_overlap;
  static constexpr double spring_power = 1.5;
  static constexpr const char* stiffness_unit = "N/m^1.5";
  static constexpr bool hertz_spring = true;
  static constexpr double steps_per_contact = 50;

  template <class Number>
  [[gnu::always_inline]] static Number spring(const Number& k, const Number& d) {
    return k * d * square_root(d);
  }
  template <class Number>
  [[gnu::always_inline]] static Number dashpot(const Number& c, const Number& d) {
    return c * square_root(square_root(d));
  }

  static double length_factor(double length) { return std::sqrt(length); }
  /// W = 2/5 k d^(5/2)
  static double energy(double k, double d) { return 0.4 * k * d * d * std::sqrt(d); }
  static ElasticImpact elastic_impact(double k, double m, double v) { return hertz_impact(k, m, v); }
  /// Without damping: 5 m v²/(4 u^(5/2)).
  static double stiffness_from_overlap(double overlap, double speed, double m, double /*damping_ratio*/) {
    return 1.25 * m * speed * speed / std::pow(overlap, 2.5);
  }

  /// c/sqrt(m k) = alpha = sqrt(5) zeta
  static double dissipation(double restitution, ContactEnd end) { return hertz_damping_of(restitution, end); }
  static double damping_ratio(double restitution, ContactEnd end) {
    return hertz_damping_of(restitution, end) / std::sqrt(5.0);
  }
  /// As for linear_dashpot, with the tangent stiffness 3/2 k d^(1/2) at the largest overlap. The dashpot alpha sqrt(m
  /// k) d^(1/4) over the critical one of that stiffness is sqrt(5/6) zeta.
  static double stable_step(double damping_ratio) { return semi_implicit_limit(std::sqrt(5.0 / 6) * damping_ratio); }
  static void check_range(double /*a*/, double /*restitution*/) {}
};

}  // namespace equidem::laws
