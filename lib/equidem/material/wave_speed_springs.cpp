// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/wave_speed_springs.hpp"

#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

void need_damping(double value) {
  if (value >= 0 && std::isfinite(value)) return;
  bad_input(fmt::format("the damping is {}", value), "a negative one would feed the motion", "Give 0 or more");
}

}  // namespace

WaveSpeeds wave_speeds_of(const ElasticModuli& moduli, double density) {
  check(moduli);
  check_positive(density, "density", "kg/m³");
  const double g = moduli.shear_modulus;
  return {std::sqrt(g / density), std::sqrt((moduli.bulk_modulus_2d() + g) / density)};
}

WaveSpeeds wave_speeds_from_shear(double shear_speed, double poisson_ratio) {
  check_positive(shear_speed, "shear wave speed", "m/s");
  if (!(poisson_ratio > -1 && poisson_ratio < 0.5)) {
    bad_input(fmt::format("Poisson's ratio is {}", poisson_ratio), "in plane strain it lies between -1 and 1/2",
              "Correct it");
  }
  return {shear_speed, shear_speed * std::sqrt(2 * (1 - poisson_ratio) / (1 - 2 * poisson_ratio))};
}

SpringConstants springs_of_wave_speeds(double density, const WaveSpeeds& speeds) {
  check_positive(density, "density", "kg/m³");
  check_positive(speeds.shear, "shear wave speed", "m/s");
  check_positive(speeds.pressure, "pressure wave speed", "m/s");
  const double quarter = std::numbers::pi / 4 * density;
  return {quarter * speeds.pressure * speeds.pressure, quarter * speeds.shear * speeds.shear};
}

double dashpot_of(double damping, double mass, double stiffness) {
  need_damping(damping);
  check_positive(mass, "mass", "kg");
  check_positive(stiffness, "stiffness", "N/m");
  return 2 * damping * std::sqrt(mass * stiffness);
}

ContactDamping contact_damping_of(double damping, bool at_wall, double inertia_factor) {
  need_damping(damping);
  check_positive(inertia_factor, "inertia factor");
  const double normal = at_wall ? damping : damping * std::numbers::sqrt2;
  return {normal, normal * std::sqrt(1 + 1 / inertia_factor)};
}

double semi_implicit_limit(double damping_ratio) {
  need_damping(damping_ratio);
  return 2 / (std::sqrt(1 + damping_ratio * damping_ratio) + damping_ratio);
}

}  // namespace equidem
