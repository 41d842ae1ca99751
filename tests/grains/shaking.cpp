// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"
#include "equidem/motion/wall.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

using std::numbers::pi;

double speed(const Schedule& s, double t, double h = 1e-6) {
  return (s.at(t + h) - s.at(t - h)) / (2 * h);
}
double acceleration(const Schedule& s, double t, double h = 1e-4) {
  return (s.at(t + h) - 2 * s.at(t) + s.at(t - h)) / (h * h);
}

}  // namespace

TEST_CASE("the_box_has_the_acceleration_asked_for") {
  for (const double wanted : {0.01, 4.0, 1e3}) {
    const Schedule s = harmonic_shaking(wanted, 10, 0.3, 5);
    double most = 0;
    for (double t = 0.301; t < 0.799; t += 0.001) {
      CAPTURE(wanted, t);
      CHECK(acceleration(s, t) == Approx(wanted * std::cos(20 * pi * (t - 0.3))).margin(2e-5 * wanted));
      most = std::max(most, std::abs(acceleration(s, t)));
    }
    CHECK(most == Approx(wanted).epsilon(1e-4));
    CHECK(s.at(0.3) == 0);
    CHECK(s.at(1) == 0);
    for (const double end : {0.3, 0.8}) CHECK(std::abs(speed(s, end)) < 1e-5 * wanted);
  }
}

TEST_CASE("shakings_without_a_meaning_are_refused") {
  CHECK_THROWS_AS(harmonic_shaking(4, 0, 0, 5), Error);
  CHECK_THROWS_AS(harmonic_shaking(4, 10, 0, 0), Error);
  std::vector<Wall> walls{line("floor", {}, {0, 1})};
  shake(walls, {1, 0}, harmonic_shaking(4, 10, 0, 5));
  CHECK(walls[0].moves());
  CHECK_FALSE(walls[0].move_y.changes());
  CHECK_THROWS_AS(shake(walls, {1, 0}, harmonic_shaking(4, 10, 0, 5)), Error);
}

TEST_CASE("a_grain_that_friction_holds_follows_the_box_and_one_that_it_cannot_hold_stays_behind") {
  // Tangential springs hold while mu g > a (a block, not a roller: the spin meets a moment of inertia beyond all).
  for (const double acceleration : {2.0, 8.0}) {
    Grain block = ball({0, 0.01}, 0.01, {}, 0.5);
    block.inertia.moment = 1e6;
    PairProperties pair;
    pair.stiffness = 1e6;
    pair.restitution = 0.2;
    pair.friction = 0.5;
    pair.tangential_ratio = 0.5;
    pair.tangential_damping = 0.3;
    std::vector<Wall> walls{line("floor", {}, {0, 1})};
    shake(walls, {1, 0}, harmonic_shaking(acceleration, 5, 0.1, 4));
    GrainSimulation simulation(scene_of({block}, walls, pair, {0, -9.81}), options_of(NormalLaw::exact_flow, 2e-5));
    double behind = 0;
    while (simulation.time() < 1) {
      simulation.advance(100);
      behind = std::max(behind, std::abs(simulation.grains()[0].position.x - walls[0].move_x.at(simulation.time())));
    }
    CAPTURE(acceleration, behind);
    if (acceleration < 0.5 * 9.81) {
      CHECK(behind < 1e-5);
    } else {
      CHECK(behind > 1e-3);
    }
  }
}
