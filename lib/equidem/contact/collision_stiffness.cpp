// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/collision_stiffness.hpp"

#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

void check_damping(double damping_ratio) {
  if (!(damping_ratio >= 0 && std::isfinite(damping_ratio))) {
    bad_input(fmt::format("the damping ratio is {:.6g}", damping_ratio), "a dashpot takes energy",
              "Give a finite number from 0 on");
  }
}

/// (1 - nu²)/E
double compliance(double young, double poisson) {
  check_positive(young, "Young modulus", "Pa");
  if (!(poisson > -1 && poisson <= 0.5)) {
    bad_input(fmt::format("the Poisson ratio is {:.6g}", poisson), "a stable solid has -1 < nu <= 0.5",
              "Give a number in that range");
  }
  return (1 - poisson) * (1 + poisson) / young;
}

}  // namespace

double stiffness_from_dimensionless(double a, double reduced_mass, double step) {
  check_positive(step, "time step", "s");
  return check_positive(a, "dimensionless stiffness") * check_positive(reduced_mass, "reduced mass", "kg") /
         (step * step);
}

double stiffness_from_overlap(double largest_overlap, double closing_speed, double reduced_mass, double damping_ratio) {
  check_damping(damping_ratio);
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
