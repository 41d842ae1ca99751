// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The order of each integrator, measured on smooth motion.
#include "equidem/dynamics/integrators.hpp"

#include <algorithm>
#include <cmath>

#include "dynamics/moving_scenes.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

double distance_of(const std::vector<DiscMotion>& a, const std::vector<DiscMotion>& b) {
  double largest = 0;
  for (std::size_t d = 0; d < a.size(); ++d) {
    largest = std::max({largest, norm(a[d].u - b[d].u), std::abs(a[d].theta - b[d].theta)});
  }
  return largest;
}

}  // namespace

TEST_CASE("every_integrator_converges_with_its_order") {
  const Integrator integrator =
      GENERATE(Integrator::leapfrog, Integrator::velocity_verlet, Integrator::thesis, Integrator::fourth_order);
  const auto motion = GENERATE(LoopKind::Motion::small, LoopKind::Motion::finite);
  const Damping damping = GENERATE(Damping{}, Damping{.mass = 0.3}, Damping{.contact = 0.1}, Damping{.stiffness = 0.1},
                                   Damping{.normal_time = 0.1}, Damping{.normal_time = 0.1, .tangential_time = 0.2});
  const bool late = damping.acts_late();
  if (late && integrator == Integrator::fourth_order) return;  // refused
  const Assembly assembly = delaunay_block(25, 6);
  const ContactSprings springs(SpringConstants{1, 0.4});
  Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  start_with(scene, random_motions(assembly.size(), 2, 0.05, 0.05));
  scene.gravity = {0, -0.01};
  constexpr double duration = 4;  // some periods of the highest frequency
  const ThreadsFor one(1);
  const auto end_of = [&](Integrator how, int steps) {
    Simulation run(scene, {.motion = motion, .integrator = how, .damping = damping, .time_step = duration / steps});
    run.advance(steps);
    return run.motions();
  };
  // With dashpots of a scheme of the same order: errors fall from 1/100 to 1/400 of the time, and are 1/16000 there.
  const std::vector<DiscMotion> exact =
      late ? end_of(Integrator::leapfrog, 16000) : end_of(Integrator::fourth_order, 2000);
  std::vector<double> errors, steps;
  for (const int count : {100, 140, 200, 280, 400}) {
    errors.push_back(std::log(distance_of(end_of(integrator, count), exact)));
    steps.push_back(std::log(duration / count));
  }
  double sxy = 0, sxx = 0, mx = 0, my = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) mx += steps[k] / 5, my += errors[k] / 5;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    sxy += (steps[k] - mx) * (errors[k] - my);
    sxx += (steps[k] - mx) * (steps[k] - mx);
  }
  const double order = sxy / sxx;
  CAPTURE(to_string(integrator), static_cast<int>(motion), damping.mass, damping.contact, order,
          std::exp(errors.front()), std::exp(errors.back()));
  const int stated = order_of({.motion = motion, .integrator = integrator, .damping = damping});
  CAPTURE(damping.stiffness, damping.normal_time, damping.tangential_time, stated);
  CHECK(order == Approx(stated).margin(0.1));
}

// q_n = cos(n theta) with sin(theta/2) = omega h/2: one disc on a spring, stepped many times.
TEST_CASE("leapfrog_oscillates_at_its_known_frequency") {
  const Assembly pair = with_each_disc_named(hexagonal_lattice({.columns = 2, .rows = 1, .radius = 0.5}));
  const ContactSprings springs(SpringConstants{1, 0});
  TimedSupport wall;
  wall.group = "0";
  wall.ux = wall.uy = always(0);
  Scene scene(pair, springs, {{1, 1}, {1, 1}});
  scene.supports = {wall};
  const double h = GENERATE(0.1, 1.0, 1.9);
  Simulation run(scene, {.time_step = h});
  displace(run, scene, h, {{}, {{1, 0}, 0}});
  const double theta = 2 * std::asin(h / 2);
  const ThreadsFor one(1);
  for (int n = 1; n <= 1000; ++n) {
    run.advance(1);
    CAPTURE(h, n);
    REQUIRE(run.motions()[1].u.x == Approx(std::cos(n * theta)).margin(1e-11));
  }
}
