// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/elasticity_tensor.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

using std::numbers::sqrt2;

/// The Kelvin basis (e_xx, e_yy, sqrt2 e_xy), in which a fourth-order tensor and its matrix have one norm and the same
/// eigenvalues, and a rotation of axes is an orthogonal matrix.
Matrix3 kelvin(const Matrix3& c) {
  Matrix3 k;
  constexpr std::array<double, 3> scale{1, 1, sqrt2};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t s = 0; s < 3; ++s) k[r][s] = scale[r] * scale[s] * 0.5 * (c[r][s] + c[s][r]);
  }
  return k;
}

double tensor_norm(const Matrix3& c) {
  double squares = 0;
  for (const auto& row : kelvin(c)) {
    for (const double entry : row) squares += entry * entry;
  }
  return std::sqrt(squares);
}

Matrix3 transposed(const Matrix3& a) {
  return {{{a[0][0], a[1][0], a[2][0]}, {a[0][1], a[1][1], a[2][1]}, {a[0][2], a[1][2], a[2][2]}}};
}

}  // namespace

SheetModuli isotropic_part(const Matrix3& c) {
  const double trace = c[0][0] + c[1][1], coupling = c[0][1] + c[1][0];
  return {.bulk = (trace + coupling) / 4, .shear = (trace - coupling + 4 * c[2][2]) / 8};
}

EffectiveModuli effective_moduli(const Matrix3& stiffness) {
  const double unit = std::ldexp(1.0, std::ilogb(largest_entry(stiffness)));  // products stay within a double
  Matrix3 c = stiffness;
  for (auto& row : c)
    for (double& entry : row) entry /= unit;
  const auto [K, G] = isotropic_part(c);
  const Matrix3 nearest = isotropic_stiffness(K, G);
  const double size = tensor_norm(nearest);
  assert(size > 0);
  const double nu = (K - G) / (2 * K);
  return {.bulk_modulus_2d = unit * K,
          .shear_modulus = unit * G,
          .poisson_strain = nu,
          .poisson_stress = (K - G) / (K + G),
          .young_strain = unit * (2 * G * (1 + nu)),
          .young_stress = unit * (4 * K * G / (K + G)),
          .anisotropy = tensor_norm(c - nearest) / size};
}

Matrix3 isotropic_stiffness(double bulk_modulus_2d, double shear_modulus) {
  const double K = bulk_modulus_2d, G = shear_modulus;
  return {{{K + G, K - G, 0}, {K - G, K + G, 0}, {0, 0, G}}};
}

Matrix3 rotated(const Matrix3& stiffness, double angle) {
  // s' = T s for stresses, e = T^T e' for strains with engineering shear, as both do the same work: C' = T C T^T.
  const double c = std::cos(angle), s = std::sin(angle);
  const Matrix3 turn{{{c * c, s * s, 2 * c * s}, {s * s, c * c, -2 * c * s}, {-c * s, c * s, c * c - s * s}}};
  return turn * stiffness * transposed(turn);
}

StiffnessEigen eigenstrains(const Matrix3& stiffness) {
  const Matrix3 k = kelvin(stiffness);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spectrum(Eigen::Map<const Eigen::Matrix3d>(k.front().data()));
  StiffnessEigen eigen;
  for (int r = 0; r < 3; ++r) {
    const Eigen::Vector3d e = spectrum.eigenvectors().col(r);
    eigen.values[r] = spectrum.eigenvalues()[r];
    eigen.strains[r] = {e[0], e[1], sqrt2 * e[2]};  // gamma = 2 e_xy = sqrt2 (sqrt2 e_xy)
  }
  return eigen;
}

Matrix3 inverse(const Matrix3& stiffness) {
  const StiffnessEigen eigen = eigenstrains(stiffness);
  const double largest = std::max(std::abs(eigen.values[0]), std::abs(eigen.values[2]));
  Matrix3 compliance{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(std::abs(eigen.values[k]) > 4 * std::numeric_limits<double>::epsilon() * largest)) {
      computation_failed(fmt::format("the stiffness is singular, with the eigenvalues {:.6g}, {:.6g} and {:.6g} Pa",
                                     eigen.values[0], eigen.values[1], eigen.values[2]),
                         "some strain meets no stress, so that there is no compliance",
                         "Give the assembly the springs or contacts that resist it");
    }
    const auto& e = eigen.strains[k];
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t s = 0; s < 3; ++s) compliance[r][s] += e[r] * e[s] / eigen.values[k];
    }
  }
  return compliance;
}

double harmonic_direction(double a, double b, int harmonic) {
  constexpr double rounding = 1e-9;  // rad: an axis just below 0 is at 0, not at the end of its range
  const double angle = std::atan2(b, a) / harmonic;
  return angle < -rounding ? angle + 2 * std::numbers::pi / harmonic : std::max(angle, 0.0);
}

StiffnessAxes stiffness_axes(const Matrix3& c) {
  // C11 seen from turned axes is a polynomial of fourth degree in cos t and sin t: harmonics 0, 2 and 4.
  const double mean = (3 * (c[0][0] + c[1][1]) + 2 * c[0][1] + 4 * c[2][2]) / 8;
  const double a2 = (c[0][0] - c[1][1]) / 2, b2 = c[0][2] + c[1][2];
  const double a4 = (c[0][0] + c[1][1] - 2 * c[0][1] - 4 * c[2][2]) / 8, b4 = (c[0][2] - c[1][2]) / 2;
  return {.one_axis = std::hypot(a2, b2) / mean,
          .one_direction = harmonic_direction(a2, b2, 2),
          .two_axes = std::hypot(a4, b4) / mean,
          .two_directions = harmonic_direction(a4, b4, 4)};
}

double margin(const Matrix3& a, const Matrix3& b) {
  const double largest = eigenstrains(b).values[2];
  assert(largest > 0);
  return eigenstrains(b - a).values[0] / largest;
}

}  // namespace equidem
