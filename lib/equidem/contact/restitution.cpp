// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/restitution.hpp"

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "equidem/core/error.hpp"

namespace equidem {
namespace {

using std::numbers::pi;

/// -ln e, +0 at e = 1.
double logarithmic_loss(double restitution) {
  return 0 - std::log(checked_restitution(restitution));
}

/// zeta of exp(-pi zeta/sqrt(1 - zeta²)) = exp(-loss); written so that loss = infinity gives 1.
double damping_at_zero_overlap(double loss) {
  return loss < pi ? loss / std::hypot(pi, loss) : 1 / std::hypot(1, pi / loss);
}

/// zeta of zeta phase(zeta) = loss where the contact ends at zero force. Left of the root, Newton's method climbs to it
/// and never passes it: zeta phase is concave and rises, from pi zeta to 2 ln(2 zeta).
double damping_at_zero_force(double loss) {
  double zeta = loss < 2 ? loss / pi : 0.35 * std::exp(loss / 2);
  for (int iteration = 0; iteration < 20; ++iteration) {
    const double phase = contact_phase_of(zeta, ContactEnd::at_zero_force);
    const double distance = 1 - zeta;
    // (phase - 2 zeta)/(1 - zeta²), and its limit where both vanish
    const double slope = std::abs(distance) < 1e-4 ? 4.0 / 3 : (phase / zeta - 2) / ((1 / zeta + 1) * distance);
    const double change = (loss - zeta * phase) / slope;
    zeta += change;
    if (!(std::abs(change) > 1e-16 * zeta)) break;
  }
  return zeta;
}

}  // namespace

double checked_restitution(double restitution) {
  check_range(Range::from(0, 1), restitution, "coefficient of restitution");
  return restitution;
}

double contact_phase_of(double damping_ratio, ContactEnd end) {
  const double zeta = damping_ratio;
  assert(zeta >= 0);
  if (end == ContactEnd::at_zero_overlap) {
    return zeta < 1 ? pi / std::sqrt((1 - zeta) * (1 + zeta)) : std::numeric_limits<double>::infinity();
  }
  if (zeta < 1) {
    const double w = std::sqrt((1 - zeta) * (1 + zeta));
    return 2 * std::atan2(w, zeta) / w;
  }
  if (zeta == 1) return 2;
  return 2 * std::acosh(zeta) / zeta / std::sqrt((zeta - 1) / zeta * ((zeta + 1) / zeta));
}

double restitution_of(double damping_ratio, ContactEnd end) {
  return std::exp(-damping_ratio * contact_phase_of(damping_ratio, end));
}

double damping_ratio_of(double restitution, ContactEnd end) {
  const double loss = logarithmic_loss(restitution);
  if (end == ContactEnd::at_zero_overlap) return damping_at_zero_overlap(loss);
  if (restitution == 0) {
    bad_input("the coefficient of restitution is 0 for a contact that ends at zero force",
              "it would need an infinite dashpot", "Give a number above 0, or end contacts at zero overlap");
  }
  return loss > 0 ? damping_at_zero_force(loss) : 0;
}

double hertz_damping_of(double restitution, ContactEnd end) {
  return std::sqrt(5.0) * damping_ratio_of(restitution, end);
}

namespace {

/// (1 - nu²)/E
double compliance(double young, double poisson) {
  check_positive(young, "Young modulus", "Pa");
  check_range({.low = -1, .high = 0.5, .low_open = true}, poisson, "Poisson ratio");
  return (1 - poisson) * (1 + poisson) / young;
}

}  // namespace

double stiffness_from_dimensionless(double a, double reduced_mass, double step) {
  check_positive(step, "time step", "s");
  return check_positive(a, "dimensionless stiffness") * check_positive(reduced_mass, "reduced mass", "kg") /
         (step * step);
}

double stiffness_from_overlap(double largest_overlap, double closing_speed, double reduced_mass, double damping_ratio) {
  check_range(Range::not_negative(), damping_ratio, "damping ratio");
  const double rate =
      check_positive(closing_speed, "closing speed", "m/s") / check_positive(largest_overlap, "largest overlap", "m");
  // The largest overlap is v/w exp(-zeta phase/2), phase that of the end at zero force.
  return check_positive(reduced_mass, "reduced mass", "kg") * rate * rate *
         restitution_of(damping_ratio, ContactEnd::at_zero_force);
}

double hertz_stiffness(double young_i, double poisson_i, double radius_i, double young_j, double poisson_j,
                       double radius_j) {
  const double modulus = 1 / (compliance(young_i, poisson_i) + compliance(young_j, poisson_j));
  const double radius = 1 / (1 / check_positive(radius_i, "radius", "m") + 1 / check_positive(radius_j, "radius", "m"));
  return 4.0 / 3 * modulus * std::sqrt(radius);
}

double hertz_stiffness_on_rigid_wall(double young, double poisson, double radius) {
  return 4.0 / 3 / compliance(young, poisson) * std::sqrt(check_positive(radius, "radius", "m"));
}

ElasticImpact linear_impact(double stiffness, double reduced_mass, double speed) {
  check_positive(stiffness, "stiffness", "N/m");
  check_positive(reduced_mass, "reduced mass", "kg");
  check_positive(speed, "closing speed", "m/s");
  const double frequency = std::sqrt(stiffness / reduced_mass);
  return {speed / frequency, stiffness * (speed / frequency), std::numbers::pi / frequency};
}

ElasticImpact hertz_impact(double stiffness, double reduced_mass, double speed) {
  check_positive(stiffness, "stiffness", "N/m^(3/2)");
  check_positive(reduced_mass, "reduced mass", "kg");
  check_positive(speed, "closing speed", "m/s");
  // twice the integral of 1/sqrt(1 - x^(5/2)) over 0..1
  static const double passage = 0.8 * std::sqrt(std::numbers::pi) * std::tgamma(0.4) / std::tgamma(0.9);
  ElasticImpact impact;
  impact.overlap = std::pow(1.25 * reduced_mass * speed * speed / stiffness, 0.4);
  impact.force = stiffness * impact.overlap * std::sqrt(impact.overlap);
  impact.duration = passage * impact.overlap / speed;
  return impact;
}

}  // namespace equidem
