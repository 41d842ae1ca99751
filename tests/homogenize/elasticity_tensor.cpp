// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Elasticity tensors: what they say does not depend on axes, and the nearest isotropic one is the mean over all axes.
#include "equidem/homogenize/elasticity_tensor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"

#include "homogenize/samples.hpp"
#include "homogenize/tensors.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;
using std::numbers::pi;

namespace {

std::vector<Matrix3> stiffnesses_of_all_kinds() {
  Random random(5);
  std::vector<Matrix3> all{isotropic_stiffness(2, 1), isotropic_stiffness(1, 2), {{{1, 0, 0}, {0, 1, 0}, {0, 0, 0.2}}}};
  for (int k = 0; k < 10; ++k) all.push_back(random_stiffness(random, {1, 1, 1}));
  all.push_back(random_stiffness(random, {1, 1}));        // a mechanism
  all.push_back(random_stiffness(random, {1, 1, 1e-9}));  // nearly one
  all.push_back(random_stiffness(random, {1, 1, -1}));    // unstable
  return all;
}

Matrix3 square_lattice_stiffness(double kN, double kT) {
  return {{{kN, 0, 0}, {0, kN, 0}, {0, 0, kT / 2}}};
}

/// sqrt(C_ijkl C_ijkl), all sixteen components one by one.
double norm_of_components(const Matrix3& c) {
  constexpr std::size_t voigt[2][2] = {{0, 2}, {2, 1}};
  double squares = 0;
  for (const auto& first : voigt) {
    for (const std::size_t r : first) {
      for (const auto& second : voigt) {
        for (const std::size_t s : second) squares += c[r][s] * c[r][s];
      }
    }
  }
  return std::sqrt(squares);
}

double distance(Matrix3 a, const Matrix3& b) {
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t s = 0; s < 3; ++s) a[r][s] -= b[r][s];
  }
  return norm_of_components(a);
}

}  // namespace

TEST_CASE("moduli_of_an_isotropic_tensor_are_those_it_was_made_of_in_both_readings") {
  for (const double G : {0.1, 1.0, 2.9, 1e9}) {
    const double K = 1.0 * std::max(G, 1.0);
    const EffectiveModuli moduli = effective_moduli(isotropic_stiffness(K, G));
    const ElasticModuli strain = moduli_from_bulk(K, G, Plane::strain);
    const ElasticModuli stress = moduli_from_bulk(K, G, Plane::stress);
    CAPTURE(K, G, moduli.anisotropy);
    CHECK(moduli.bulk_modulus_2d == Approx(K).epsilon(1e-14));
    CHECK(moduli.shear_modulus == Approx(G).epsilon(1e-14));
    CHECK(moduli.poisson_strain == Approx(strain.poisson_ratio).epsilon(1e-14).margin(1e-15));
    CHECK(moduli.poisson_stress == Approx(stress.poisson_ratio).epsilon(1e-14).margin(1e-15));
    CHECK(moduli.young_strain == Approx(strain.young_modulus()).epsilon(1e-14));
    CHECK(moduli.young_stress == Approx(stress.young_modulus()).epsilon(1e-14));
    CHECK(moduli.anisotropy < 1e-15);
  }
}

TEST_CASE("moduli_and_anisotropy_do_not_depend_on_the_axes") {
  for (const Matrix3& c : stiffnesses_of_all_kinds()) {
    const EffectiveModuli before = effective_moduli(c);
    const StiffnessEigen eigen_before = eigenstrains(c);
    const double size = norm_of_components(c);
    for (int k = 0; k < 37; ++k) {
      const double angle = -4 + 0.3 * k;
      const Matrix3 seen = rotated(c, angle);
      const EffectiveModuli after = effective_moduli(seen);
      const StiffnessEigen eigen_after = eigenstrains(seen);
      CAPTURE(shown(c), angle, before.anisotropy, after.anisotropy);
      CHECK(std::abs(after.bulk_modulus_2d - before.bulk_modulus_2d) < 1e-14 * size);
      CHECK(std::abs(after.shear_modulus - before.shear_modulus) < 1e-14 * size);
      CHECK(after.anisotropy == Approx(before.anisotropy).epsilon(1e-13).margin(1e-14));
      for (std::size_t e = 0; e < 3; ++e) {
        CHECK(std::abs(eigen_after.values[e] - eigen_before.values[e]) < 1e-14 * size);
      }
      CHECK(relative_difference(rotated(seen, -angle), c) < 1e-14);
    }
  }
}

TEST_CASE("turned_axes_see_the_turned_stress_of_the_turned_strain") {
  // C' e' = s' with tensors turned as e'_ij = R_ik R_jl e_kl: no Voigt matrix in it.
  Random random(6);
  for (const Matrix3& c : stiffnesses_of_all_kinds()) {
    const double angle = random.uniform(-pi, pi);
    const Vec2 x{std::cos(angle), std::sin(angle)}, y = perpendicular(x);
    const auto seen = [&](const Tensor2& t) {
      return Tensor2{dot(x, t * x), dot(x, t * y), dot(y, t * x), dot(y, t * y)};
    };
    const Tensor2 h = random_tensor(random);
    const Tensor2 e{h.xx, 0.5 * (h.xy + h.yx), 0.5 * (h.xy + h.yx), h.yy};
    const Voigt s = stress_of(c, voigt_strain(e));
    const Voigt expected = voigt_stress(seen({s.xx, s.xy, s.xy, s.yy}));
    const Voigt found = stress_of(rotated(c, angle), voigt_strain(seen(e)));
    CAPTURE(shown(c), angle);
    CHECK(found.xx == Approx(expected.xx).epsilon(1e-13).margin(1e-14));
    CHECK(found.yy == Approx(expected.yy).epsilon(1e-13).margin(1e-14));
    CHECK(found.xy == Approx(expected.xy).epsilon(1e-13).margin(1e-14));
  }
}

TEST_CASE("nearest_isotropic_tensor_is_the_mean_over_all_directions") {
  for (const Matrix3& c : stiffnesses_of_all_kinds()) {
    const EffectiveModuli moduli = effective_moduli(c);
    const Matrix3 nearest = isotropic_stiffness(moduli.bulk_modulus_2d, moduli.shear_modulus);
    Matrix3 mean{};
    constexpr int directions = 7;  // more than four: the harmonics of a fourth-order tensor end there
    for (int k = 0; k < directions; ++k) {
      const Matrix3 seen = rotated(c, 2 * pi * k / directions);
      for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t s = 0; s < 3; ++s) mean[r][s] += seen[r][s] / directions;
      }
    }
    const double least = distance(c, nearest);
    CAPTURE(shown(c), shown(mean), shown(nearest), least);
    CHECK(relative_difference(mean, nearest) < 1e-14);
    CHECK(moduli.anisotropy == Approx(least / norm_of_components(nearest)).epsilon(1e-13).margin(1e-15));
    for (const double dK : {-0.01, 0.0, 0.01}) {
      for (const double dG : {-0.01, 0.0, 0.01}) {
        CHECK(distance(c, isotropic_stiffness(moduli.bulk_modulus_2d + dK, moduli.shear_modulus + dG)) >=
              least - 1e-15);
      }
    }
  }
}

TEST_CASE("eigenstrains_reproduce_the_stiffness") {
  const double scale = GENERATE(1e-150, 1.0, 1e9, 1e150);
  for (Matrix3 c : stiffnesses_of_all_kinds()) {
    for (auto& row : c) {
      for (double& entry : row) entry *= scale;
    }
    const StiffnessEigen eigen = eigenstrains(c);
    CAPTURE(scale, shown(c), eigen.values[0], eigen.values[1], eigen.values[2], shown(eigen.strains));
    CHECK(std::is_sorted(eigen.values.begin(), eigen.values.end()));
    Matrix3 rebuilt{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& e = eigen.strains[k];
      const double as_stress[3] = {e[0], e[1], e[2] / 2};
      for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t s = 0; s < 3; ++s) rebuilt[r][s] += eigen.values[k] * as_stress[r] * as_stress[s];
      }
      for (std::size_t m = 0; m < 3; ++m) {
        const auto& f = eigen.strains[m];
        CHECK(std::abs(e[0] * f[0] + e[1] * f[1] + e[2] * f[2] / 2 - (k == m ? 1 : 0)) < 1e-14);  // e : f
      }
    }
    CHECK(relative_difference(rebuilt, c) < 1e-14);
  }
}

TEST_CASE("compliance_undoes_the_stiffness") {
  // kT/kN from 1e-8 to 1e8, seen along and across the rows of a square lattice.
  const double angle = GENERATE(0.0, 0.3);
  for (const double ratio : {1e-8, 1e-3, 1.0, 1e3, 1e8}) {
    const Matrix3 compliance = inverse(rotated(square_lattice_stiffness(1, ratio), angle));
    // The compliance turns with the inverse transpose: shear e_xy in place of gamma doubles and quadruples.
    Matrix3 expected{{{1, 0, 0}, {0, 1, 0}, {0, 0, 0.5 / ratio}}};  // e_ij = S_ijkl s_kl, S_1212 = 1/(4 C66)
    expected = rotated(expected, angle);
    for (std::size_t r = 0; r < 3; ++r) expected[r][2] *= 2, expected[2][r] *= 2;
    CAPTURE(angle, ratio, shown(compliance), shown(expected));
    CHECK(relative_difference(compliance, expected) < 1e-15 * (1 + (angle != 0 ? std::max(ratio, 1 / ratio) : 0)));
  }
  for (const Matrix3& c : stiffnesses_of_all_kinds()) {
    const StiffnessEigen eigen = eigenstrains(c);
    const double condition = std::max(std::abs(eigen.values[0]), eigen.values[2]) / std::abs(eigen.values[0]);
    if (std::abs(eigen.values[0]) < 1e-14) continue;
    const Matrix3 s = inverse(c);
    double worst = 0;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t k = 0; k < 3; ++k) {
        double entry = r == k ? -1 : 0;
        for (std::size_t m = 0; m < 3; ++m) entry += c[r][m] * s[m][k];
        worst = std::max(worst, std::abs(entry));
      }
    }
    CAPTURE(shown(c), condition, worst);
    CHECK(worst < 1e-14 * (1 + condition));
  }
}

TEST_CASE("stiffness_of_a_mechanism_has_no_compliance") {
  Random random(7);
  for (const Matrix3& c : {square_lattice_stiffness(1e9, 0), isotropic_stiffness(1, 0),
                           random_stiffness(random, {1, 1}), random_stiffness(random, {1}), Matrix3{}}) {
    const std::string message = message_of([&] { static_cast<void>(inverse(c)); });
    CAPTURE(shown(c), message);
    CHECK(contains(message, "the stiffness is singular, with the eigenvalues"));
  }
}

TEST_CASE("margin_is_the_least_room_between_two_stiffnesses") {
  Random random(8);
  for (int k = 0; k < 50; ++k) {
    const Matrix3 a = random_stiffness(random, {1, 1, 1});
    Matrix3 above = a, crossing = a;
    const Matrix3 more = random_stiffness(random, {1, 1, 1}), either = random_stiffness(random, {1, -1});
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t s = 0; s < 3; ++s) above[r][s] += more[r][s], crossing[r][s] += either[r][s];
    }
    CAPTURE(shown(a), shown(more), shown(either));
    CHECK(margin(a, a) == 0);
    CHECK(margin(a, above) > 0);
    CHECK(margin(above, a) < 0);
    CHECK(margin(a, crossing) < 0);  // neither is above the other
    CHECK(margin(crossing, a) < 0);
    const double angle = random.uniform(-pi, pi);
    CHECK(margin(rotated(a, angle), rotated(above, angle)) == Approx(margin(a, above)).epsilon(1e-12).margin(1e-14));
  }
  // Half of it over 2K, the largest eigenvalue.
  CHECK(margin(isotropic_stiffness(2, 1), isotropic_stiffness(4, 2)) == Approx(2.0 / 8).epsilon(1e-15));
}
