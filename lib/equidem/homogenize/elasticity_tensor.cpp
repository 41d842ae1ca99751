// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/elasticity_tensor.hpp"

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

/// One Jacobi rotation: the entry (p, q) of k becomes zero; row p and row q of the vectors turn along.
void annihilate(Matrix3& k, Matrix3& vectors, std::size_t p, std::size_t q) {
  if (k[p][q] == 0) return;
  const double half_cotangent = 0.5 * (k[q][q] - k[p][p]) / k[p][q];  // of twice the angle: cot(2 phi)
  const double tangent =
      std::copysign(1.0, half_cotangent) / (std::abs(half_cotangent) + std::hypot(1.0, half_cotangent));
  const double cosine = 1 / std::hypot(1.0, tangent), sine = tangent * cosine;
  const auto turn = [&](double& a, double& b) {
    const double was = a;
    a = cosine * was - sine * b;
    b = sine * was + cosine * b;
  };
  for (std::size_t r = 0; r < 3; ++r) turn(k[r][p], k[r][q]);
  for (std::size_t r = 0; r < 3; ++r) turn(k[p][r], k[q][r]);
  for (std::size_t r = 0; r < 3; ++r) turn(vectors[p][r], vectors[q][r]);
  k[p][q] = k[q][p] = 0;
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
  // Cyclic Jacobi: eigenvectors orthogonal to round-off, and small eigenvalues of a graded positive definite matrix to
  // their own relative accuracy (Demmel & Veselic 1992). It converges quadratically; six sweeps are usual.
  Matrix3 k = kelvin(stiffness);
  Matrix3 vectors{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const auto negligible = [&](std::size_t p, std::size_t q) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    return std::abs(k[p][q]) <= 0.1 * epsilon * std::sqrt(std::abs(k[p][p])) * std::sqrt(std::abs(k[q][q]));
  };
  for (int sweep = 0; sweep < 50 && !(negligible(0, 1) && negligible(0, 2) && negligible(1, 2)); ++sweep) {
    annihilate(k, vectors, 0, 1);
    annihilate(k, vectors, 0, 2);
    annihilate(k, vectors, 1, 2);
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return k[a][a] < k[b][b]; });
  StiffnessEigen eigen;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto& e = vectors[order[r]];
    eigen.values[r] = k[order[r]][order[r]];
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

double margin(const Matrix3& a, const Matrix3& b) {
  const double largest = eigenstrains(b).values[2];
  assert(largest > 0);
  return eigenstrains(b - a).values[0] / largest;
}

}  // namespace equidem
