// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A law of a longer list, the quadratic spring: it collides in every loop without a further line of code.
#include <cmath>
#include <vector>

#include "equidem/contact/laws/normal_law.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr NormalLaw quadratic = NormalLaw::quadratic_spring;

/// An elastic impact of reduced mass 1 at a closing speed of 1 m/s lasts one second.
PairProperties one_second_quadratic() {
  const ElasticImpact unit = describe(quadratic).elastic_impact(1, 1, 1);
  return {.stiffness = std::pow(unit.duration, 3), .restitution = 1};
}

GrainOptions stepping(GrainIntegrator integrator, double step) {
  return options_of(Stepping{quadratic, integrator}, step);
}

double order_of_error(const std::vector<double>& errors) {
  return std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
}

/// Largest error of the ledger while discs of three sizes cross each other's ways.
double error_of_ledger(const GrainScene& scene, const GrainOptions& options, double until) {
  GrainSimulation simulation(scene, options);
  double largest = 0;
  while (simulation.time() < until) {
    simulation.advance(1);
    const EnergyLedger ledger = simulation.energy();
    largest = std::max(largest, std::abs(ledger.error()) / ledger.initial);
  }
  REQUIRE(simulation.counters().contacts > 0);
  return largest;
}

/// Three discs that meet at an angle, and two walls.
GrainScene crowd() {
  return scene_of({ball({0, 1.2}, 1, {0.2, -1}), ball({1.1, 3}, 1, {-0.1, -0.7}), ball({2.4, 1.3}, 1, {-1, 0.1})},
                  {line("floor", {0, 0}, {0, 1}), line("left", {-1.3, 0}, {1, 0})}, one_second_quadratic());
}

}  // namespace

TEST_CASE("an_impact_of_quadratic_springs_is_elastic_and_as_deep_and_long_as_theory_says") {
  const GrainIntegrator integrator = GENERATE(GrainIntegrator::semi_implicit_euler, GrainIntegrator::velocity_verlet);
  const bool on_wall = GENERATE(false, true), shapes = GENERATE(false, true);
  // reduced mass 1
  std::vector<Grain> grains{ball({0, 0}, 1, {1, 0}, on_wall ? 1 : 2)};
  if (!on_wall) grains.push_back(ball({2.01, 0}, 1, {0, 0}, 2));
  if (shapes) {
    Grain ellipse = ball({0, 10}, 1);
    ellipse.short_half_axis = 0.5;
    for (Grain& grain : grains) grain.short_half_axis = 0.5;  // ellipses that meet along their long axes
    grains.push_back(ellipse);
  }
  std::vector<Wall> walls;
  if (on_wall) walls.push_back(line("wall", {1.01, 0}, {-1, 0}));
  const double step = 1e-3;
  GrainSimulation simulation(scene_of(grains, walls, one_second_quadratic()), stepping(integrator, step));
  double deepest = 0;
  std::int64_t steps = 0;
  for (std::int64_t k = 0; k < 3000; ++k) {
    simulation.advance(1);
    for (const GrainContact& contact : simulation.contacts()) deepest = std::max(deepest, contact.overlap);
    steps += simulation.contacts().empty() ? 0 : 1;
  }
  const std::vector<Grain> after = simulation.grains();
  const double restitution = on_wall ? -after[0].velocity.x : after[1].velocity.x - after[0].velocity.x;
  const ElasticImpact theory = describe(quadratic).elastic_impact(one_second_quadratic().stiffness, 1, 1);
  CAPTURE(static_cast<int>(integrator), on_wall, shapes, restitution, deepest, theory.overlap, steps);
  CHECK(restitution == Approx(1).epsilon(1e-5));
  CHECK(deepest == Approx(theory.overlap).epsilon(1e-3));
  CHECK(static_cast<double>(steps) * step == Approx(theory.duration).epsilon(0.01));
}

TEST_CASE("the_ledger_of_quadratic_springs_closes_to_the_order_of_the_scheme") {
  const GrainIntegrator integrator = GENERATE(GrainIntegrator::semi_implicit_euler, GrainIntegrator::velocity_verlet);
  std::vector<double> errors;
  for (const double step : {0.02, 0.01, 0.005, 0.0025}) {
    errors.push_back(error_of_ledger(crowd(), stepping(integrator, step), 4));
  }
  const double order = order_of_error(errors);
  CAPTURE(static_cast<int>(integrator), errors, order);
  CHECK(errors.back() < 0.01);
  CHECK(order > (integrator == GrainIntegrator::semi_implicit_euler ? 0.9 : 1.9));
}

TEST_CASE("quadratic_springs_move_clumps_and_ellipses_without_loss") {
  const GrainIntegrator integrator = GrainIntegrator::velocity_verlet;
  GrainScene scene = crowd();
  scene.grains[0].short_half_axis = 0.6;
  scene.clumps = {{{{{-0.5, 0}, 0.5}, {{0.5, 0}, 0.5}}}};
  scene.grains[1].clump = 0;
  std::vector<double> errors;
  for (const double step : {0.01, 0.005, 0.0025})
    errors.push_back(error_of_ledger(scene, stepping(integrator, step), 4));
  const double order = order_of_error(errors);
  CAPTURE(static_cast<int>(integrator), errors, order);
  CHECK(errors.back() < 0.01);
  CHECK(order > 1.5);
}

TEST_CASE("a_law_of_a_longer_list_is_known_by_its_name") {
  CHECK(enum_from<NormalLaw>("quadratic_spring") == quadratic);
  CHECK(to_string(quadratic) == "quadratic_spring");
  CHECK(std::string(describe(quadratic).letter) == "Q");
  CAPTURE(names_of_laws(LawKind::force));
  CHECK(names_of_laws(LawKind::force).ends_with(" or quadratic_spring"));
}
