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
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "equidem/core/error.hpp"

#include "contact/numbers.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;
using std::numbers::pi;

namespace {

// Impacts of spring and dashpot by the classical Runge-Kutta method, with mass, spring and speed 1: an oracle for
// closed forms.

struct IntegratedImpact {
  double restitution = 0, duration = 0, overlap = 0;  ///< overlap: largest
};

/// \param rate y' of the state y = (x, v, t)
/// \param remains positive while the contact lasts
template <typename Rate, typename Remains>
std::array<long double, 3> integrate_until(Rate rate, Remains remains, long double& largest_x) {
  constexpr long double step = 1e-3L;
  using State = std::array<long double, 3>;
  const auto moved = [](const State& y, const State& k, long double h) {
    return State{y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2]};
  };
  const auto advance = [&](const State& y, long double h) {
    const State a = rate(y), b = rate(moved(y, a, h / 2)), c = rate(moved(y, b, h / 2)), d = rate(moved(y, c, h));
    return moved(
        y, {a[0] + 2 * b[0] + 2 * c[0] + d[0], a[1] + 2 * b[1] + 2 * c[1] + d[1], a[2] + 2 * b[2] + 2 * c[2] + d[2]},
        h / 6);
  };
  const auto zero_of = [&](const State& y, auto f) {
    long double low = 0, high = step;
    for (int i = 0; i < 70; ++i) {
      const long double middle = (low + high) / 2;
      (f(advance(y, middle)) > 0 ? low : high) = middle;
    }
    return advance(y, (low + high) / 2);
  };
  State y{0, 1, 0};
  for (long i = 0; i < 10000000; ++i) {
    const State next = advance(y, step);
    if (y[1] > 0 && next[1] <= 0) {
      const State turning = zero_of(y, [](const State& at) { return at[1]; });
      largest_x = turning[0];
    }
    if (remains(next) <= 0) return zero_of(y, remains);
    y = next;
  }
  throw std::runtime_error("the impact did not end");
}

/// u'' + 2 zeta u' + u = 0 from u = 0, u' = 1.
IntegratedImpact integrate_linear_impact(double damping_ratio, ContactEnd end) {
  const long double c = 2 * static_cast<long double>(damping_ratio);
  long double overlap = 0;
  const auto y = integrate_until(
      [c](const auto& s) {
        return std::array<long double, 3>{s[1], -s[0] - c * s[1], 1};
      },
      [c, end](const auto& s) { return end == ContactEnd::at_zero_overlap ? s[0] : s[0] + c * s[1]; }, overlap);
  return {static_cast<double>(-y[1]), static_cast<double>(y[2]), static_cast<double>(overlap)};
}

/// d'' + alpha d^(1/4) d' + d^(3/2) = 0 from d = 0, d' = 1, with d = x^4 and time dt = 4 x³ dtau, which leaves no
/// roots: x' = v, v' = -4 x³ (x^6 + alpha x v).
IntegratedImpact integrate_hertz_impact(double alpha, ContactEnd end) {
  long double largest = 0;
  const auto y = integrate_until(
      [alpha](const auto& s) {
        const long double x = s[0], cube = x * x * x;
        return std::array<long double, 3>{s[1], -4 * cube * (cube * cube + alpha * x * s[1]), 4 * cube};
      },
      [alpha, end](const auto& s) {
        const long double x = s[0];
        return end == ContactEnd::at_zero_overlap || x < 0 ? x : x * x * x * x * x + alpha * s[1];
      },
      largest);
  return {static_cast<double>(-y[1]), static_cast<double>(y[2]),
          static_cast<double>(largest * largest * largest * largest)};
}

}  // namespace

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
