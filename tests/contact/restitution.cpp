// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Restitution, duration and depth of impacts with spring and dashpot against an independent integration, and the
/// springs and dashpots that give them.
#include "equidem/contact/restitution.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>

#include <nlohmann/json.hpp>

#include "equidem/core/error.hpp"

#include "contact/integrated_impact.hpp"
#include "contact/numbers.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;
using std::numbers::pi;

TEST_CASE("restitution_is_that_of_the_integrated_impact") {
  for (const ContactEnd end : {ContactEnd::at_zero_overlap, ContactEnd::at_zero_force}) {
    for (const double zeta : {0.0, 1e-3, 0.05, 0.1, 0.3, 0.5, 0.7071, 0.8, 0.95, 1.0, 1.2, 3.0}) {
      if (end == ContactEnd::at_zero_overlap && zeta > 0.9) continue;  // hardly ends, or never
      const IntegratedImpact exact = integrate_linear_impact(zeta, end);
      CAPTURE(to_string(end), zeta, exact.restitution, restitution_of(zeta, end), exact.duration);
      CHECK(std::abs(restitution_of(zeta, end) - exact.restitution) < 1e-11);
      CHECK(std::abs(contact_phase_of(zeta, end) - exact.duration) < 1e-10 * exact.duration);
    }
  }
}

TEST_CASE("restitution_agrees_with_the_table_of_both_readings") {  // Schwager & Poeschel 2007
  const std::array<double, 6> zeta{0.05, 0.1, 0.3, 0.5, 0.8, 1.2};
  const std::array<double, 6> cut{0.85876, 0.74408, 0.45098, 0.29844, 0.17978, 0.10521};
  const std::array<double, 6> uncut{0.85447, 0.72925, 0.37233, 0.16303, 0.01517, 0};
  for (std::size_t i = 0; i < zeta.size(); ++i) {
    CAPTURE(zeta[i]);
    CHECK(std::abs(restitution_of(zeta[i], ContactEnd::at_zero_force) - cut[i]) < 1e-5);
    CHECK(std::abs(restitution_of(zeta[i], ContactEnd::at_zero_overlap) - uncut[i]) < 1e-5);
  }
}

TEST_CASE("damping_gives_the_restitution_asked_for") {
  for (const ContactEnd end : {ContactEnd::at_zero_overlap, ContactEnd::at_zero_force}) {
    const bool force = end == ContactEnd::at_zero_force;
    const auto check = [&](double e) {
      const double zeta = damping_ratio_of(e, end), back = restitution_of(zeta, end);
      CAPTURE(to_string(end), e, zeta, back);
      CHECK(zeta >= 0);
      CHECK(std::abs(back - e) <= 3 * epsilon);
      // No neighbour of zeta is nearer by more than the rounding of ln e.
      if (force && e > 0) CHECK(std::abs(back - e) <= 4 * epsilon * e * (1 + std::abs(std::log(e))));
    };
    for (double e = 1; e > 1e-300; e *= 0.93) check(e);
    for (double gap = 1e-16; gap < 1; gap *= 1.7) check(1 - gap);
    for (double near = -1e-3; near < 1e-3; near += 1.7e-5) check(std::exp(-2 + near));  // zeta = 1 at zero force
    CHECK(damping_ratio_of(1, end) == 0);
  }
  CHECK(damping_ratio_of(std::exp(-2.0), ContactEnd::at_zero_force) == Approx(1).epsilon(1e-15));
  CHECK(damping_ratio_of(0, ContactEnd::at_zero_overlap) == 1);
  CHECK(restitution_of(1, ContactEnd::at_zero_overlap) == 0);
}

TEST_CASE("damping_is_found_for_every_restitution_that_a_number_can_hold") {
  for (const double e : {5e-324, 1e-310, std::numeric_limits<double>::min(), 1e-100}) {
    const double zeta = damping_ratio_of(e, ContactEnd::at_zero_force);
    // e -> 1/(4 zeta²)
    CAPTURE(e, zeta);
    CHECK(-2 * std::log(2 * zeta) == Approx(std::log(e)).epsilon(1e-14));
  }
}

TEST_CASE("a_hertz_impact_has_the_restitution_asked_for") {
  for (const ContactEnd end : {ContactEnd::at_zero_overlap, ContactEnd::at_zero_force}) {
    for (const double e : {0.2, 0.3, 0.5, 0.7, 0.9, 0.98, 1.0}) {
      const IntegratedImpact exact = integrate_hertz_impact(hertz_damping_of(e, end), end);
      CAPTURE(to_string(end), e, exact.restitution);
      CHECK(std::abs(exact.restitution - e) < 1e-10);
    }
  }
  CHECK(hertz_damping_of(0) == std::sqrt(5.0));
}

TEST_CASE("dashpots_agree_with_the_independent_implementation") {
  nlohmann::json reference;
  std::ifstream(EQUIDEM_SOURCE_DIR "/data/reference/impact_traces.json") >> reference;
  CHECK(damping_ratio_of(0.7, ContactEnd::at_zero_overlap) == Approx(reference["gamma"].get<double>()).epsilon(1e-15));
  CHECK(hertz_damping_of(0.7) == Approx(reference["alpha_T"].get<double>()).epsilon(1e-15));
  for (const char* e : {"0.3", "0.7", "0.9"}) {
    const auto& row = reference[std::string("T_e_") + e];
    const double zeta = damping_ratio_of(std::stod(e), ContactEnd::at_zero_overlap);
    CHECK(std::abs(restitution_of(zeta, ContactEnd::at_zero_force) - row["linear_exit_f0"].get<double>()) < 1e-8);
    CHECK(std::abs(restitution_of(zeta, ContactEnd::at_zero_force) - row["exit_f0"].get<double>()) < 1e-8);
  }
}

TEST_CASE("a_restitution_that_no_dashpot_gives_is_refused") {
  for (const double e : {-0.1, 1.1, std::nan("")}) {
    CHECK_THROWS_WITH(damping_ratio_of(e, ContactEnd::at_zero_overlap), Catch::Contains("from 0 to 1"));
    CHECK_THROWS_AS(damping_ratio_of(e, ContactEnd::at_zero_force), Error);
    CHECK_THROWS_AS(hertz_damping_of(e), Error);
  }
  CHECK_THROWS_WITH(damping_ratio_of(0, ContactEnd::at_zero_force), Catch::Contains("infinite dashpot"));
}

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
