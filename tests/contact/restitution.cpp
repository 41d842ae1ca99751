// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Restitution of spring and dashpot against an independent integration of the impact, and its inverse.
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
