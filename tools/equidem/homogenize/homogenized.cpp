// SPDX-License-Identifier: GPL-3.0-or-later
#include "homogenize/homogenized.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace equidem {

DisplacementOperator displacement_operator(const EffectiveStiffness& result) {
  const Matrix4& c = result.gradient_stiffness;
  const EffectiveModuli moduli = effective_moduli(result.stiffness);
  const double kappa = 0.25 * (c[2][2] + c[3][3] - c[2][3] - c[3][2]);
  return {.shear_modulus = moduli.shear_modulus + kappa, .bulk_modulus_2d = moduli.bulk_modulus_2d - kappa};
}

std::vector<StiffnessBeside> Homogenized::ordered() const {
  std::vector<StiffnessBeside> order;
  if (problem.springs.springs.any_negative()) return order;
  for (const std::string key : {"traction", "periodic", "displacement", "voigt"}) {
    if (key == to_string(result.boundary)) order.push_back({key, key, result.stiffness, {}});
    for (const StiffnessBeside& other : beside)
      if (other.key == key && other.stiffness) order.push_back(other);
  }
  return order;
}

StiffnessAxes stiffness_axes(const Matrix3& c) {
  // C11 seen from turned axes is a polynomial of fourth degree in cos t and sin t: harmonics 0, 2 and 4.
  const double mean = (3 * (c[0][0] + c[1][1]) + 2 * c[0][1] + 4 * c[2][2]) / 8;
  const double a2 = (c[0][0] - c[1][1]) / 2, b2 = c[0][2] + c[1][2];
  const double a4 = (c[0][0] + c[1][1] - 2 * c[0][1] - 4 * c[2][2]) / 8, b4 = (c[0][2] - c[1][2]) / 2;
  const auto direction = [](double a, double b, int harmonic) {
    constexpr double rounding = 1e-9;  // rad: an axis just below 0 is at 0, not at the end of its range
    const double angle = std::atan2(b, a) / harmonic;
    return angle < -rounding ? angle + 2 * std::numbers::pi / harmonic : std::max(angle, 0.0);
  };
  return {.one_axis = std::hypot(a2, b2) / mean,
          .one_direction = direction(a2, b2, 2),
          .two_axes = std::hypot(a4, b4) / mean,
          .two_directions = direction(a4, b4, 4)};
}

}  // namespace equidem
