// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What has next to nothing to act on it: no gravity, one grain.
#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/packing/measures.hpp"
#include "equidem/packing/packing.hpp"

#include "hard_cases/bodies.hpp"
#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("without_gravity_bodies_keep_their_momenta_and_rest_stays_rest") {
  HardCase table({.name = "zero gravity",
                  .why = "nothing brings bodies together or holds them, there is no weight to compare with, and errors "
                         "of free flight add up over all steps"});
  for (const BodyKind kind : all_bodies) {
    GrainScene scene = scene_of({}, {}, {.stiffness = 1e4, .restitution = 0.8});
    scene.pairs[0].friction = 0.4;
    scene.pairs[0].tangential_ratio = 0.5;
    Random random(9);
    for (int k = 0; k < 16; ++k) {
      const Vec2 place{2.0 * (k % 4) - 3, 2.0 * std::floor(k / 4) - 3};
      add_body(scene, kind, place, 0.9, random.uniform(-3, 3), -place);
    }
    for (Grain& g : scene.grains) g.velocity += Vec2{0.3, 0.2};
    const std::size_t far = scene.grains.size();
    add_body(scene, kind, {1000, 1000}, 0.9, 0.7);
    GrainSimulation simulation(scene, verlet(1e-4));
    const Balance balance = keep(simulation, 60000);
    CAPTURE(name_of(kind), balance.energy, balance.momentum, balance.angular, balance.contacts);
    CHECK(balance.contacts > 10);
    CHECK(balance.momentum < 1e-12);
    CHECK(balance.angular < 1e-12);
    CHECK(balance.energy < 2e-3);
    CHECK(simulation.energy().potential == 0);
    const std::vector<Grain> after = simulation.grains();
    bool same = true;
    for (std::size_t k = far; k < after.size(); ++k) {
      const Grain &a = after[k], &b = scene.grains[k];
      same = same && a.position == b.position && a.velocity == b.velocity && a.angle == b.angle && a.spin == b.spin;
    }
    CHECK(same);
    table.note("16 fly at each other, one rests far away, " + name_of(kind),
               "momenta to 1e-12, energy to 2e-3; what rests keeps its bits",
               fmt::format("momentum {}, angular {}, energy {}; {}", digits(balance.momentum), digits(balance.angular),
                           digits(balance.energy), same ? "the same bits" : "other bits"));
  }
  // a million steps of free flight
  GrainScene scene = scene_of({oval({0, 0}, 1, 0.5, 0.2, {0.3, -0.7})}, {}, {.stiffness = 1});
  scene.grains[0].spin = 0.1;
  GrainSimulation simulation(scene, verlet(1e-3));
  simulation.advance(1000000);
  const Grain out = simulation.grains()[0];
  const double off = norm(out.position - Vec2{300, -700}) / 761.6, turned = std::abs(out.angle - 100.2) / 100.2;
  CAPTURE(off, turned);
  CHECK(off < 1e-10);
  CHECK(turned < 1e-10);
  CHECK(out.velocity == scene.grains[0].velocity);
  CHECK(out.spin == scene.grains[0].spin);
  table.note("an ellipse flies 1e6 steps", "place and angle to 1e-10, velocities to the bit",
             fmt::format("place {}, angle {}", digits(off), digits(turned)));
  PackingOptions options;
  options.method = PackingMethod::falling;
  options.box = {{5, 0}, PackingBox::Sides::open_top};
  options.radii = {1};
  options.settling.springs = {1e7, 5e6};
  options.settling.gravity = 0;
  table.refused("pack by falling", attempt([&] { pack(options); }),
                {"gravity of the settling is 0", "Give a number > 0"});
}

TEST_CASE("one_grain_falls_rebounds_and_rests") {
  HardCase table({.name = "one grain",
                  .why = "no neighbours, no contacts, no scale but its own: lists, means and ratios are of nothing"});
  for (const BodyKind kind : all_bodies) {
    std::vector<double> errors;
    for (const double step : {1e-3, 5e-4, 2.5e-4}) {
      GrainScene scene = scene_of({}, {line("floor", {0, 0}, {0, 1})}, {.stiffness = 1e4}, {0, -1});
      add_body(scene, kind, {0, 2}, 1, 0.4);
      GrainSimulation simulation(scene, verlet(step));
      const Balance balance = keep(simulation, static_cast<std::int64_t>(std::llround(10 / step)));
      CAPTURE(name_of(kind), step, balance.contacts);
      CHECK(balance.contacts > 1);
      errors.push_back(balance.energy);
    }
    CAPTURE(name_of(kind), errors);
    CHECK(errors[2] < 1e-3);
    CHECK(errors[2] < errors[0] / 2.5);
    table.note("bouncing for 10 s, e = 1, " + name_of(kind), "energy to 1e-3, falling with the step",
               fmt::format("{}, {}, {}", digits(errors[0]), digits(errors[1]), digits(errors[2])));

    GrainScene scene = scene_of({}, {line("floor", {0, 0}, {0, 1})}, {.stiffness = 1e4, .restitution = 0.1}, {0, -1});
    add_body(scene, kind, {0, 1}, 1, kind == BodyKind::clump ? -2.356 : 0);
    scene.pairs[0].friction = 0.5;
    scene.pairs[0].tangential_ratio = 0.5;
    scene.pairs[0].tangential_damping = 0.5;
    GrainSimulation simulation(scene, verlet(5e-4));
    simulation.advance(200000);
    const double mass = kind == BodyKind::bonded_pair ? 2 : 1;
    double carried = 0, pressed = 0;
    for (const GrainContact& c : simulation.contacts()) {
      carried += c.normal_force;
      pressed += 1e4 * c.overlap;
    }
    const double lack = std::max(std::abs(carried / mass - 1), std::abs(pressed / mass - 1));
    CAPTURE(name_of(kind), lack, simulation.energy().kinetic, simulation.contacts().size());
    CHECK(lack < 1e-9);
    table.note("at rest on the floor, " + name_of(kind), "force and stiffness times overlap are the weight to 1e-9",
               digits(lack));
  }
  for (const auto& entry : EnumNames<PackingMethod>::list) {
    PackingOptions options;
    options.method = entry.value;
    const bool falls = entry.value == PackingMethod::falling;
    options.box = {{5, falls ? 0.0 : 5}, falls ? PackingBox::Sides::open_top : PackingBox::Sides::walls};
    options.radii = {1};
    options.settling.springs = {1e7, 5e6};
    const GrainPacking packing = pack(options);
    REQUIRE(packing.size() == 1);
    const Rectangle all{{-1, -1}, {6, 6}};  // a bit of what fell is in the floor
    const double off = std::abs(measure(packing, all).solid_fraction * all.area() / std::numbers::pi - 1);
    CAPTURE(entry.name, off, packing.settling.unbalanced);
    CHECK(off < 1e-12);
    CHECK(packing.settling.unbalanced <= 1e-6);
    table.note(std::string("pack by ") + entry.name, "it is there, its area to 1e-12", digits(off));
  }
}
