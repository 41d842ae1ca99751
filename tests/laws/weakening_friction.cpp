// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A tangential law of a longer list: friction that falls with the slip velocity acts in every loop.
#include <cmath>
#include <vector>

#include "equidem/contact/laws/normal_law.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("an_oblique_impact_loses_the_slip_that_friction_which_falls_with_it_takes") {
  const GrainIntegrator integrator = GENERATE(GrainIntegrator::semi_implicit_euler, GrainIntegrator::velocity_verlet);
  const bool on_wall = GENERATE(false, true), shapes = GENERATE(false, true), several_kinds = GENERATE(false, true);
  // Discs of 1 kg, I = m r²/2. The normal impulse J takes dv = -(inverse mass) mu/(1 + v/v_w) dJ of the slip:
  // v + v²/(2 v_w) falls by (inverse mass) mu J. A constant mu would leave 0.775 of 1 m/s.
  PairProperties pair;
  pair.friction = 0.05;
  pair.stiffness = 1e8;
  pair.restitution = 0.5;
  pair.tangential_ratio = 0.5;
  std::vector<Grain> grains{ball({0, 1}, 1, {1, -1}, 1, 0.5)};
  std::vector<Wall> walls;
  if (on_wall) {
    walls.push_back(line("floor", {0, 0}, {0, 1}));
  } else {
    grains.push_back(ball({0, -1}, 1, {}, 1, 0.5));
  }
  if (shapes) {
    grains.push_back(ball({10, 20}, 1));
    grains.back().short_half_axis = 0.5;
  }
  GrainScene scene = scene_of(grains, walls, pair);
  if (several_kinds) {
    scene.kinds = 2;
    scene.pairs = {pair, pair, pair, pair};
    scene.pairs.back().friction = 0;
  }
  GrainSimulation simulation(scene, options_of(Stepping{NormalLaw::weakening_friction, integrator}, 1e-6));
  simulation.advance(600);
  REQUIRE(simulation.contacts().empty());
  const std::vector<Grain> after = simulation.grains();
  const double inverse_mass = on_wall ? 3 : 6, weak = laws::WeakeningCoulomb::speed;
  const double impulse = after[0].velocity.y + 1;
  const double root = 1 + 1 / (2 * weak) - inverse_mass * pair.friction * impulse;
  const double expected = weak * (std::sqrt(1 + 2 * root / weak) - 1);
  const double found = after[0].velocity.x + after[0].spin - (on_wall ? 0 : after[1].velocity.x - after[1].spin);
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(static_cast<int>(integrator), on_wall, shapes, several_kinds, impulse, found, expected, ledger.error(),
          ledger.lost_slip);
  CHECK(impulse == Approx(on_wall ? 1.5 : 0.75).epsilon(0.01));
  CHECK(std::abs(found - expected) < 2e-3);
  CHECK(std::abs(ledger.error()) < 0.02 * ledger.lost_slip);
}
