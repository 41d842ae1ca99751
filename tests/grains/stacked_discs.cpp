// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fujioka & Ushijima (2005), section 5.6: a sphere slides down between two others and impulses them apart; contact
/// that lasts, several at once. Exact for rigid spheres.
#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double stacked_radius = 0.02, gravity = 9.8;

/// Height of the upper sphere over 2 r0 when it leaves the others, the real root of k³ + 3 k = sqrt(3), (29).
double separation() {
  const double s3 = std::sqrt(3.0), s7 = std::sqrt(7.0);
  return std::cbrt((s3 + s7) / 2) + std::cbrt((s3 - s7) / 2);
}

/// Final velocity of the lower spheres over sqrt(4 g r0), (28).
double exact_velocity() {
  const double k = separation();
  return std::sqrt((std::sqrt(0.75) - k) * k * k / (1 + k * k));
}

/// When they separate, (30): the integral with t = sqrt(3)/2 - x², by the midpoint rule.
double exact_time() {
  const double top = std::sqrt(0.75);
  const double end = std::sqrt(top - separation());
  const int n = 20000;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double x = end * (i + 0.5) / n;
    const double t = top - x * x;
    sum += 2 * std::sqrt((1 + t * t) / (1 - t * t));
  }
  return std::sqrt(stacked_radius / gravity) * sum * end / n;
}

struct Errors {
  double velocity = 0, time = 0;  // relative
};

Errors run(NormalLaw law, double step) {
  PairProperties pair;
  // held as the step falls: contacts grow stiffer, the spheres rigid
  pair.dimensionless = law == NormalLaw::hertz_dashpot ? 4.62 : 0.1;
  pair.restitution = 0.7;
  std::vector<Grain> grains;
  for (const Vec2 place : {Vec2{-stacked_radius, stacked_radius}, Vec2{stacked_radius, stacked_radius},
                           Vec2{0, (1 + std::sqrt(3.0)) * stacked_radius}}) {
    grains.push_back(ball(place, stacked_radius));
    grains.back().inertia = inertia_of(stacked_radius, 1000, Body::sphere);
  }
  GrainSimulation simulation(scene_of(grains, {line("floor", {0, 0}, {0, 1})}, pair, {0, -gravity}),
                             options_of(law, step));
  double parted = 0;
  while (simulation.time() < 0.11) {
    simulation.advance(1);
    for (const GrainContact& contact : simulation.contacts()) {
      if (contact.i == 1 && contact.j == 2) parted = simulation.time();
    }
  }
  const double velocity = simulation.grains()[1].velocity.x / std::sqrt(4 * gravity * stacked_radius);
  CHECK(simulation.grains()[0].velocity.x == Approx(-simulation.grains()[1].velocity.x).epsilon(1e-9));
  return {std::abs(velocity / exact_velocity() - 1), std::abs(parted / exact_time() - 1)};
}

}  // namespace

TEST_CASE("the_closed_form_of_stacked_spheres_has_its_known_values") {
  CHECK(separation() == Approx(0.528222288593158).epsilon(1e-14));
  CHECK(exact_velocity() == Approx(0.271462651012440).epsilon(1e-14));
  CHECK(exact_time() == Approx(0.106736872469562).epsilon(1e-8));
}

TEST_CASE("stacked_spheres_slide_apart_as_rigid_ones_do") {
  const NormalLaw law = GENERATE(from_range(all_laws));
  std::vector<double> velocity, time;
  for (const double step : {1e-3, 1e-4, 1e-5}) {
    const Errors errors = run(law, step);
    velocity.push_back(errors.velocity);
    time.push_back(errors.time);
  }
  const double order = std::log10(velocity.front() / velocity.back()) / 2;
  CAPTURE(to_string(law), velocity, time, order);
  // Springs grow as 1/dt², so their overlaps fall as dt²; those of Hertz as dt^(4/3). When contact ends is felt only to
  // the root of it.
  CHECK(order > (law == NormalLaw::hertz_dashpot ? 0.9 : 1.6));
  CHECK(velocity.back() < (law == NormalLaw::hertz_dashpot ? 1e-4 : 1e-5));
  CHECK(time.back() < 3e-3);
}
