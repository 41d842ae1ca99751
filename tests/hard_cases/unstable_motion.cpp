// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonded discs in motion with negative tangential springs, and friction far above that of any material.
#include <cmath>

#include "equidem/core/text.hpp"

#include "hard_cases/bodies.hpp"
#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("with_a_friction_of_ten_bodies_roll_where_they_would_slide") {
  HardCase table({.name = "friction 10",
                  .why =
                      "no contact slides up to 84 degrees: the tangential spring carries ten times the normal force, "
                      "and any jump of the friction limit would be seen"});
  for (const double degrees : {20.0, 60.0, 80.0}) {
    const double slope = degrees * std::numbers::pi / 180, g = 9.8;
    const Vec2 down{std::cos(slope), -std::sin(slope)}, normal{std::sin(slope), std::cos(slope)};
    GrainScene scene = scene_of({}, {line("slope", {0, 0}, normal)}, {.stiffness = 1e5, .restitution = 0.1}, {0, -g});
    const double sunk = g * std::cos(slope) / 1e5;
    add_body(scene, BodyKind::disc, (1 - sunk) * normal, 1);
    scene.pairs[0].friction = 10;
    scene.pairs[0].tangential_ratio = 0.5;
    scene.pairs[0].tangential_damping = 0.5;
    GrainSimulation simulation(scene, verlet(1e-4));
    const double inertia = scene.grains[0].inertia.moment / scene.grains[0].inertia.mass;
    const auto speed_after = [&](std::int64_t steps) {
      simulation.advance(steps);
      return dot(simulation.grains()[0].velocity, down);
    };
    const double first = speed_after(10000), second = speed_after(10000);
    const double expected = g * std::sin(slope) / (1 + inertia);  // rolling: a = g sin/(1 + I/(m r²)), r = 1
    const double off = std::abs(second - first - expected) / expected;
    CAPTURE(degrees, first, second, expected, off);
    CHECK(off < 1e-3);
    table.note(fmt::format("a disc on a slope of {:.0f} degrees, 20000 steps", degrees),
               "rolls, with the acceleration of rolling to 1e-3", digits(off));
  }
}
