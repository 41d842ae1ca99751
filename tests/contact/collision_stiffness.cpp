// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Springs from duration, overlap or material constants: the impact is the one asked for.
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "equidem/contact/restitution.hpp"
#include "equidem/core/error.hpp"

#include "contact/integrated_impact.hpp"
#include "support/catch.hpp"

using namespace equidem;
using std::numbers::pi;

namespace {

double sphere_mass(double density, double radius) {
  return density * 4 / 3 * pi * radius * radius * radius;
}

}  // namespace

TEST_CASE("a_linear_impact_goes_as_deep_as_asked") {
  const double mass = 0.37, speed = 2.3, overlap = 4e-4;
  for (const ContactEnd end : {ContactEnd::at_zero_overlap, ContactEnd::at_zero_force}) {
    for (const double zeta : {0.0, 0.05, 0.3, 0.8, 1.0, 1.2}) {
      if (end == ContactEnd::at_zero_overlap && zeta >= 1) continue;
      // In time sqrt(m/k) and length v sqrt(m/k) the impact has mass, spring and speed 1.
      const IntegratedImpact unit = integrate_linear_impact(zeta, end);
      const double for_overlap = stiffness_from_overlap(overlap, speed, mass, zeta);
      CAPTURE(to_string(end), zeta, for_overlap, unit.overlap);
      CHECK(unit.overlap * speed * std::sqrt(mass / for_overlap) == Approx(overlap).epsilon(1e-10));
    }
  }
  CHECK(stiffness_from_overlap(overlap, speed, mass, 0) ==
        Approx(mass * speed * speed / (overlap * overlap)).epsilon(1e-14));
}

TEST_CASE("the_dimensionless_stiffness_is_k_dt2_over_m") {
  const double k = 3e5, mass = 0.2, step = 1e-4;
  CHECK(stiffness_from_dimensionless(k * step * step / mass, mass, step) == Approx(k).epsilon(1e-15));
}

TEST_CASE(
    "elastic_peaks_are_those_of_chung_and_ooi") {  // Granular Matter 13 (2011) 643, tests 1 and 2, exact Hertz values
  struct Row {
    const char* name;
    double young, poisson, density, radius, speed;
    bool wall;
    double overlap_um, force_kN, duration_us;  // to the digits written
    double force_digit, duration_digit;
  };
  const std::array<Row, 4> rows{{{"glass", 48e9, 0.20, 2800, 0.01, 10, false, 274.11, 10.697, 40.34, 1e-3, 1e-2},
                                 {"limestone", 20e9, 0.25, 2500, 0.01, 10, false, 368.30, 7.108, 54.20, 1e-3, 1e-2},
                                 {"aluminium", 70e9, 0.30, 2699, 0.1, 0.2, true, 49.72, 11.370, 731.7, 1e-3, 1e-1},
                                 {"magnesium", 40e9, 0.35, 1800, 0.1, 0.2, true, 52.12, 7.233, 767.1, 1e-3, 1e-1}}};
  for (const Row& row : rows) {
    const double mass = sphere_mass(row.density, row.radius);
    const double k = row.wall ? hertz_stiffness_on_rigid_wall(row.young, row.poisson, row.radius)
                              : hertz_stiffness(row.young, row.poisson, row.radius, row.young, row.poisson, row.radius);
    const ElasticImpact impact = hertz_impact(k, row.wall ? mass : mass / 2, row.wall ? row.speed : 2 * row.speed);
    CAPTURE(row.name, k, impact.overlap, impact.force, impact.duration);
    CHECK(std::abs(impact.overlap * 1e6 - row.overlap_um) < 0.51e-2);
    CHECK(std::abs(impact.force * 1e-3 - row.force_kN) < 0.51 * row.force_digit);
    CHECK(std::abs(impact.duration * 1e6 - row.duration_us) < 0.51 * row.duration_digit);
  }
}

TEST_CASE("a_wall_is_a_large_rigid_body") {
  const double wall = hertz_stiffness_on_rigid_wall(70e9, 0.3, 0.1);
  CHECK(hertz_stiffness(70e9, 0.3, 0.1, 1e30, 0.3, 1e20) == Approx(wall).epsilon(1e-14));
  CHECK(hertz_stiffness(70e9, 0.3, 0.1, 5e9, 0.2, 0.02) == Approx(hertz_stiffness(5e9, 0.2, 0.02, 70e9, 0.3, 0.1)));
}

TEST_CASE("springs_that_no_number_gives_are_refused") {
  const double bad = GENERATE(0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan(""));
  CAPTURE(bad);
  CHECK_THROWS_AS(stiffness_from_dimensionless(bad, 1, 1), Error);
  CHECK_THROWS_AS(stiffness_from_dimensionless(1, bad, 1), Error);
  CHECK_THROWS_WITH(stiffness_from_dimensionless(1, 1, bad), Catch::Contains("time step"));
  CHECK_THROWS_AS(stiffness_from_overlap(bad, 1, 1, 0), Error);
  CHECK_THROWS_AS(stiffness_from_overlap(1, bad, 1, 0), Error);
  CHECK_THROWS_AS(stiffness_from_overlap(1, 1, bad, 0), Error);
  CHECK_THROWS_WITH(hertz_stiffness(bad, 0.3, 1, 1, 0.3, 1), Catch::Contains("Young"));
  CHECK_THROWS_AS(hertz_stiffness(1, 0.3, 1, 1, 0.3, bad), Error);
  CHECK_THROWS_AS(hertz_stiffness_on_rigid_wall(1, 0.3, bad), Error);
  CHECK_THROWS_AS(hertz_impact(bad, 1, 1), Error);
  CHECK_THROWS_AS(hertz_impact(1, 1, bad), Error);
  CHECK_THROWS_WITH(hertz_stiffness_on_rigid_wall(1, 0.6, 1), Catch::Contains("<= 0.5"));
}
