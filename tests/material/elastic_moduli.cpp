// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One sheet, two readings: plane strain and plane stress.
#include "equidem/material/elastic_moduli.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// G from 0.1 to 1000, nu across the range of its reading.
std::vector<ElasticModuli> moduli_of_all_kinds() {
  std::vector<ElasticModuli> all;
  for (const double G : {0.1, 1.0, 1000.0}) {
    for (const double nu : {-0.99, -0.5, -0.1, 0.0, 0.2, 0.25, 0.3, 0.49}) all.push_back({G, nu, Plane::strain});
    for (const double nu : {-0.49, -0.1, 0.0, 0.25, 1.0 / 3, 0.5, 0.99}) all.push_back({G, nu, Plane::stress});
  }
  return all;
}

bool same(double a, double b) {
  return std::abs(a - b) <= 1e-13 * (1 + std::abs(a));
}

}  // namespace

TEST_CASE("readings_convert_back_and_forth_without_changing_the_sheet") {
  for (const ElasticModuli& moduli : moduli_of_all_kinds()) {
    const Plane other = moduli.plane == Plane::strain ? Plane::stress : Plane::strain;
    const ElasticModuli read = moduli.read_as(other);
    CAPTURE(moduli.shear_modulus, moduli.poisson_ratio, to_string(moduli.plane), read.poisson_ratio);
    CHECK(read.shear_modulus == moduli.shear_modulus);
    CHECK(read.plane == other);
    CHECK(read.bulk_modulus_2d() == Approx(moduli.bulk_modulus_2d()).epsilon(1e-12));
    CHECK(same(read.lame_lambda() / moduli.bulk_modulus_2d(), moduli.lame_lambda() / moduli.bulk_modulus_2d()));
    CHECK(same(read.read_as(moduli.plane).poisson_ratio, moduli.poisson_ratio));
    CHECK(moduli.read_as(moduli.plane).poisson_ratio == moduli.poisson_ratio);
  }
}

TEST_CASE("stress_of_a_uniaxial_test_follows_from_the_moduli_of_each_reading") {
  // Hooke's law of the sheet, sigma = lambda tr(eps) + 2 G eps, decides what E and nu mean.
  for (const ElasticModuli& moduli : moduli_of_all_kinds()) {
    const double lambda = moduli.lame_lambda();
    const double G = moduli.shear_modulus;
    const double nu = moduli.poisson_ratio;
    CAPTURE(G, nu, to_string(moduli.plane));
    if (moduli.plane == Plane::stress) {
      const double s11 = lambda * (1 - nu) + 2 * G;
      const double s22 = lambda * (1 - nu) - 2 * G * nu;
      CHECK(s11 == Approx(moduli.young_modulus()).epsilon(1e-12));
      CHECK(std::abs(s22) <= 1e-12 * (std::abs(lambda) + G));
    } else {
      // Plane strain: s11 = E/(1 - nu²) for e22 = -nu/(1 - nu) e11.
      const double e22 = -nu / (1 - nu);
      const double s11 = lambda * (1 + e22) + 2 * G;
      const double s22 = lambda * (1 + e22) + 2 * G * e22;
      CHECK(s11 == Approx(moduli.young_modulus() / (1 - nu * nu)).epsilon(1e-12));
      CHECK(std::abs(s22) <= 1e-12 * (std::abs(lambda) + G));
    }
  }
}

TEST_CASE("moduli_are_rebuilt_from_young_and_from_bulk") {
  for (const ElasticModuli& moduli : moduli_of_all_kinds()) {
    CAPTURE(moduli.shear_modulus, moduli.poisson_ratio, to_string(moduli.plane));
    const auto by_young = moduli_from_young(moduli.young_modulus(), moduli.poisson_ratio, moduli.plane);
    CHECK(by_young.shear_modulus == Approx(moduli.shear_modulus).epsilon(1e-12));
    const auto by_bulk = moduli_from_bulk(moduli.bulk_modulus_2d(), moduli.shear_modulus, moduli.plane);
    CHECK(same(by_bulk.poisson_ratio, moduli.poisson_ratio));
    CHECK(by_bulk.plane == moduli.plane);
  }
}

TEST_CASE("moduli_out_of_range_are_refused_with_value_and_bound") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double G : {0.0, -1.0, nan, infinity}) {
    CHECK_THROWS_WITH(check(ElasticModuli{G, 0.2}),
                      Catch::Contains("shear modulus is ") && Catch::Contains("> 0 and finite"));
  }
  for (const double nu : {-1.0, 0.5, 0.7, nan, infinity}) {
    CHECK_THROWS_WITH(check(ElasticModuli{1, nu, Plane::strain}),
                      Catch::Contains("in plane strain") && Catch::Contains("between -1 and 0.5"));
  }
  for (const double nu : {-1.0, 1.0, 1.5, nan}) {
    CHECK_THROWS_WITH(check(ElasticModuli{1, nu, Plane::stress}),
                      Catch::Contains("in plane stress") && Catch::Contains("between -1 and 1"));
  }
  CHECK_THROWS_WITH(check(ElasticModuli{1, 0.6, Plane::strain}), Catch::Contains("set plane stress"));
  CHECK_NOTHROW(check(ElasticModuli{1, 0.6, Plane::stress}));
  CHECK_THROWS_WITH(moduli_from_young(-3, 0.2, Plane::strain), Catch::Contains("Young's modulus is -3 Pa"));
  CHECK_THROWS_WITH(moduli_from_bulk(0, 1, Plane::strain), Catch::Contains("bulk modulus is 0 Pa"));
  CHECK_THROWS_WITH(moduli_from_bulk(1, 4, Plane::strain), Catch::Contains("Read it in plane stress"));
  CHECK(moduli_from_bulk(1, 4, Plane::stress).poisson_ratio == Approx(-0.6));
}
