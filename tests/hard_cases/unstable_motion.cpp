// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonded discs in motion with negative tangential springs, and friction far above that of any material.
#include <cmath>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/statics/critical_ratio.hpp"

#include "dynamics/moving_scenes.hpp"
#include "hard_cases/bodies.hpp"
#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("bonded_discs_with_negative_tangential_springs_keep_their_energy_or_are_refused") {
  HardCase table({.name = "kT < 0 in motion",
                  .why =
                      "with free rotations every kT < 0 makes motions grow, though statics is stable; with restrained "
                      "ones a ratio below the critical one does"});
  const Assembly block = hexagonal_lattice({.columns = 8, .rows = 8});
  const std::vector<Support> held{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}};
  const double critical =
      find_critical_ratio(block, ContactSprings(SpringConstants{1, 1}), held, {.rotation = false}).ratio;
  CAPTURE(critical);
  REQUIRE(critical < -0.01);
  const auto scene_with = [&](const ContactSprings& springs) {
    Scene scene(block, springs, inertia_of(block, 2650, Body::disc));
    scene.supports = held_still(block, held);
    scene.velocities = {{.group = "right", .velocity = {0.01, 0.004}}};
    return scene;
  };
  const double stable = 0.9 * critical, unstable = 1.5 * critical;
  {
    const ContactSprings springs = springs_of(stable);
    const Scene scene = scene_with(springs);
    SimulationOptions options{.rotation = Rotation::restrained};
    options.time_step = 0.5 * choose_time_step(scene, options, {}).critical;
    Simulation simulation(scene, options);
    simulation.advance(20000);
    const EnergyLedger ledger = simulation.energy();
    const double off = std::abs(ledger.error()) / ledger.initial, kinetic = ledger.kinetic / ledger.initial;
    CAPTURE(off, kinetic);
    CHECK(off < 1e-9);
    CHECK(kinetic < 1 + 1e-9);
    table.note("run, restrained rotation, 0.9 times the critical ratio, 20000 steps",
               "energy to 1e-9, never more kinetic than there was", "energy " + digits(off));
  }
  for (const bool turning : {false, true}) {
    const double ratio = turning ? -0.01 : unstable;
    const ContactSprings springs = springs_of(ratio);
    const Scene scene = scene_with(springs);
    SimulationOptions options{.rotation = turning ? Rotation::free : Rotation::restrained};
    const std::string task =
        turning ? "run, free rotation, kT/kN = -0.01" : "run, restrained rotation, 1.5 times the critical ratio";
    table.refused(task, attempt([&] { choose_time_step(scene, options, {}); }), {"whatever the step"});
    const TimeStep step = choose_time_step(scene, options, {.fraction = 0.5, .allow_unstable = true});
    REQUIRE(step.growth_rate > 0);
    // After some growth the fastest mode is alone, and the kinetic energy grows with twice its rate.
    options.time_step = step.step;
    Simulation simulation(scene, options);
    const auto count = static_cast<std::int64_t>(std::ceil(2 / (step.growth_rate * step.step)));
    simulation.advance(10 * count);
    const double before = simulation.energy().kinetic;
    simulation.advance(count);
    const double rate = 0.5 * std::log(simulation.energy().kinetic / before) / (static_cast<double>(count) * step.step);
    CAPTURE(ratio, rate, step.growth_rate);
    CHECK(rate >= 0.98 * step.growth_rate);
    CHECK(rate <= 1.5 * step.growth_rate);
    table.note(task + ", allowed", "grows at 0.98 to 1.5 times the rate told",
               fmt::format("{:.3f} times", rate / step.growth_rate));
  }
}

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
