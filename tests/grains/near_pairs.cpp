// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The packed loops over pairs of discs and of parts.
#include "grains/resuming.hpp"
#include "grains/scenes.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

// Any number beside zero grows there: a column is as unstable as a rod on its tip.
TEST_CASE("discs_above_one_another_stay_so_to_the_last_bit") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double friction = GENERATE(0.0, 0.4);
  std::vector<Grain> column;
  for (int k = 0; k < 20; ++k) column.push_back(ball({0, 1.0 + 1.99 * k}, 1));
  PairProperties pair;
  pair.stiffness = 1e4;
  pair.restitution = 0.5;
  pair.friction = friction;
  pair.tangential_ratio = 0.5;
  GrainSimulation simulation(scene_of(column, {line("floor", {0, 0}, {0, 1})}, pair, {0, -1}),
                             options_of(stepping, 0.001));
  simulation.advance(500);
  CAPTURE(stepping.name(), friction);
  CHECK(simulation.counters().contacts > 19);
  for (const Grain& grain : simulation.grains()) {
    CHECK(grain.position.x == 0);
    CHECK(grain.velocity.x == 0);
    CHECK(grain.spin == 0);
  }
}

TEST_CASE("contacts_of_needles_are_those_that_brute_force_finds") {
  const double margin = GENERATE(0.0, 1e-6, 2.0);
  GrainOptions options = options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 3e-4);
  options.margin = margin;
  GrainSimulation simulation(flying_needles(24, 31), options);
  std::size_t found = 0;
  for (int k = 0; k < 400; ++k) {
    simulation.advance(20);
    std::vector<std::pair<int, int>> expected, listed;
    const std::vector<Grain> grains = simulation.grains();
    const auto shape = [](const Grain& grain) {
      return Ellipse{grain.radius, grain.short_half_axis, axis_at(grain.angle)};
    };
    for (std::size_t i = 0; i < grains.size(); ++i) {
      for (std::size_t j = i + 1; j < grains.size(); ++j) {
        const Vec2 branch = grains[j].position - grains[i].position;
        if (contact_of_ellipses(shape(grains[i]), shape(grains[j]), branch).gap < 0) expected.emplace_back(i, j);
      }
    }
    for (const GrainContact& contact : simulation.contacts()) {
      if (contact.j >= 0) listed.emplace_back(std::minmax(contact.i, contact.j));
    }
    std::sort(listed.begin(), listed.end());
    CAPTURE(margin, k, expected.size(), listed.size());
    REQUIRE(listed == expected);
    found += expected.size();
  }
  CAPTURE(margin, simulation.counters().contacts, simulation.counters().rebuilds);
  CHECK(found > 20);
  CHECK(simulation.counters().contacts > 50);
  CHECK(simulation.counters().rebuilds > 2);
}
