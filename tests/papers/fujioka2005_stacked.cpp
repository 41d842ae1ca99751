// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fujioka & Ushijima (2005), section 5.6: a sphere slides down between two others, without friction.
#include <cmath>

#include "papers/fujioka2005_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace fujioka2005;

namespace {

/// Exact k of eq. (29), d' of eq. (28), T0 of eq. (30) with t = sqrt3/2 - x², by Simpson's rule.
struct Exact {
  double k = 0, speed = 0, parting = 0;
};

Exact exact_slide() {
  const double s3 = std::sqrt(3.0), s7 = std::sqrt(7.0);
  Exact exact;
  exact.k = std::cbrt(0.5 * (s3 + s7)) + std::cbrt(0.5 * (s3 - s7));
  exact.speed = std::sqrt((0.5 * s3 - exact.k) * exact.k * exact.k / (1 + exact.k * exact.k));
  const double length = std::sqrt(0.5 * s3 - exact.k);
  constexpr int pieces = 2000;
  double sum = 0;
  for (int j = 0; j <= pieces; ++j) {
    const double x = length * j / pieces, t = 0.5 * s3 - x * x;
    const double weight = j == 0 || j == pieces ? 1 : j % 2 == 1 ? 4 : 2;
    sum += weight * 2 * std::sqrt((1 + t * t) / (1 - t * t));
  }
  exact.parting = std::sqrt(stacked_radius / gravity) * sum * length / (3 * pieces);
  return exact;
}

struct Errors {
  double speed = 0, parting = 0;  ///< relative, of d' and T0
};

Errors slide(const PairProperties& pair, NormalLaw law, double step) {
  static const Exact exact = exact_slide();
  GrainSimulation run = start(stacked(pair), law, step);
  const std::int64_t late = law == NormalLaw::exact_flow ? 1 : 0;  // it lists the contacts at the end of a step
  double parting = 0;
  while (run.time() < 1.3 * exact.parting) {
    run.advance(1);
    for (const GrainContact& contact : run.contacts()) {
      if (contact.i == 1 && contact.j == 2) parting = static_cast<double>(run.step() + late) * step;
    }
  }
  const double speed = run.grains()[1].velocity.x / std::sqrt(4 * gravity * stacked_radius);
  return {std::abs(speed / exact.speed - 1), std::abs(parting / exact.parting - 1)};
}

/// From steps of 1e-4 s to 1e-5 s.
double order(double coarse, double fine) {
  return std::log10(coarse / fine);
}

}  // namespace

TEST_CASE("fujioka_2005_exact_solution_of_the_stacked_spheres") {
  const Exact exact = exact_slide();
  CHECK(exact.k * exact.k * exact.k + 3 * exact.k == Approx(std::sqrt(3.0)).epsilon(1e-15));
  CHECK(exact.k == Approx(0.528222288593158).epsilon(1e-14));
  CHECK(exact.speed == Approx(0.271462651012440).epsilon(1e-14));
  CHECK(exact.parting == Approx(0.106736872469562).epsilon(1e-13));

  // The sum (31) omits the singular end, zeta(1/2) sqrt7 sqrt(Delta).
  const int pieces = 1000000;
  const double top = 0.5 * std::sqrt(3.0), width = (top - exact.k) / pieces;
  double sum = 0;
  for (int j = 0; j < pieces; ++j) {
    const double t = exact.k + j * width;
    sum += width * std::sqrt((1 + t * t) / ((top - t) * (1 - t * t)));
  }
  const double low = std::sqrt(stacked_radius / gravity) * sum - exact.parting;
  constexpr double zeta_of_half = -1.4603545088095868;
  CHECK(low == Approx(std::sqrt(stacked_radius / gravity) * zeta_of_half * std::sqrt(7 * width)).epsilon(1e-3));
}

TEST_CASE("fujioka_2005_stacked_spheres_errors_fall_with_the_step_for_all_laws_but_C") {
  struct Row {
    NormalLaw law;
    double speed, parting;  ///< least orders of d' and T0
    double speed_error;     ///< largest at 1e-5 s
  };
  // T0 is resolved to one step; the springs of T soften as depths decrease with the step
  const Row row = GENERATE(Row{NormalLaw::hertz_dashpot, 1.0, 0.5, 1e-4}, Row{NormalLaw::five_case_map, 1.5, 0.6, 1e-5},
                           Row{NormalLaw::energy_map, 1.5, 0.6, 1e-5}, Row{NormalLaw::exact_flow, 1.8, 0.9, 2e-6});
  const Errors coarse = slide(pair_of(row.law), row.law, 1e-4), fine = slide(pair_of(row.law), row.law, 1e-5);
  CAPTURE(describe(row.law).letter, coarse.speed, fine.speed, coarse.parting, fine.parting);
  CHECK(fine.speed < row.speed_error);
  CHECK(order(coarse.speed, fine.speed) > row.speed);
  CHECK(order(coarse.parting, fine.parting) > row.parting);
}

TEST_CASE("fujioka_2005_stacked_spheres_C_stops_improving_by_the_lag_of_its_damping") {
  const auto slide_of_C = [](double e, double step) {
    return slide(pair_of(NormalLaw::linear_dashpot, e), NormalLaw::linear_dashpot, step);
  };
  const Errors coarse = slide_of_C(0.7, 1e-4), fine = slide_of_C(0.7, 1e-5);
  CAPTURE(coarse.speed, fine.speed, coarse.parting, fine.parting);
  CHECK(order(coarse.speed, fine.speed) < 0.2);
  CHECK(std::abs(order(coarse.parting, fine.parting)) < 0.2);
  // the adhesion is proportional to the damping: half the damping gives half the error of T0
  const double zeta = damping_ratio_of(0.7, ContactEnd::at_zero_overlap);
  const Errors half = slide_of_C(restitution_of(0.5 * zeta, ContactEnd::at_zero_overlap), 1e-5);
  CAPTURE(half.parting);
  CHECK(fine.parting / half.parting == Approx(2).epsilon(0.1));
}

TEST_CASE("stacked_spheres_by_exact_flow_may_be_stiffer_and_so_nearer_at_the_same_step") {
  PairProperties stiff = pair_of(NormalLaw::exact_flow);
  stiff.dimensionless = 4;
  for (const double step : {1e-3, 1e-4}) {
    const Errors x = slide(stiff, NormalLaw::exact_flow, step);
    const Errors p = slide(pair_of(NormalLaw::energy_map), NormalLaw::energy_map, step);
    CAPTURE(step, x.speed, p.speed, x.parting, p.parting);
    CHECK(x.speed < 0.2 * p.speed);
    CHECK(x.parting < p.parting);
  }
}
