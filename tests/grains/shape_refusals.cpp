// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Ellipses and clumps that cannot be stepped, and steps that would let them pass through one another.
#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

GrainScene two(const Grain& a, const Grain& b) {
  return scene_of({a, b}, {}, {.stiffness = 100});
}

std::string refusal(const GrainScene& scene, NormalLaw law = NormalLaw::linear_dashpot) {
  const auto place = [](std::size_t grain) { return "grain " + std::to_string(grain); };
  const Refusal refused = refusal_of([&] { check(scene, options_of(law, 0.01), place); });
  CHECK(refused.kind == ErrorKind::bad_input);
  return refused.message;
}

}  // namespace

TEST_CASE("scenes_of_shapes_that_cannot_be_stepped_are_refused") {
  using Catch::Contains;
  const Grain fine = oval({9, 9}, 1, 0.5);
  CHECK(refusal(two(fine, oval({0, 0}, 1, 0.5))).empty());
  CHECK_THAT(refusal(two(fine, oval({0, 0}, 1, 1.5))), Contains("short half-axis 1.5") && Contains("grain 1"));
  CHECK_THAT(refusal(two(fine, oval({0, 0}, 1, -0.5))), Contains("short half-axis -0.5"));
  Grain unknown = fine;
  unknown.short_half_axis = std::nan("");
  CHECK_THAT(refusal(two(ball({0, 0}, 1), unknown)), Contains("short half-axis nan"));
  // concentric, nested, centre in the other
  CHECK_THAT(refusal(two(fine, fine)), Contains("start inside one another"));
  CHECK_THAT(refusal(two(oval({0, 0}, 2, 1), oval({0.5, 0}, 0.5, 0.1))), Contains("start inside one another"));
  CHECK_THAT(refusal(two(oval({0, 0}, 2, 1), oval({0, 1.1}, 2, 1, 1.5))), Contains("start inside one another"));
  // needles: one runs through the other, far from the centres of both; its tip presses on the other's side
  CHECK_THAT(refusal(two(oval({0, 0}, 2, 0.1), oval({1.2, 1.4}, 2, 0.1, 1.5))), Contains("start inside one another"));
  CHECK(refusal(two(oval({0, 0}, 2, 0.1), oval({1.2, 2.06}, 2, 0.1, 1.5))).empty());
  // side by side, nearer than half an axis, they are not
  CHECK(refusal(two(oval({0, 0}, 2, 0.1), oval({0, 0.25}, 2, 0.1))).empty());
  for (const NormalLaw law : exact_laws) {
    CHECK_THAT(refusal(two(fine, oval({0, 0}, 1, 0.5)), law), Contains("Use linear_dashpot or hertz_dashpot"));
  }
  CHECK_THAT(refusal(two(fine, ball({0, 0}, 1, {}, 1, 0.4))), Contains("is a sphere"));

  GrainScene scene = scene_of({}, {}, {.stiffness = 100});
  scene.grains = {lump(scene, pair_of_discs(), {0, 0})};
  CHECK(refusal(scene).empty());
  const auto changed = [&](auto change) {
    GrainScene other = scene;
    change(other);
    return refusal(other);
  };
  CHECK_THAT(changed([](GrainScene& s) { s.grains[0].clump = 3; }), Contains("is clump 3") && Contains("has 1"));
  CHECK_THAT(changed([](GrainScene& s) { s.grains[0].clump = -2; }), Contains("is clump -2"));
  CHECK_THAT(changed([](GrainScene& s) { s.grains[0].short_half_axis = 1; }), Contains("is an ellipse and clump 0"));
  CHECK_THAT(changed([](GrainScene& s) { s.grains[0].radius = 1.9; }), Contains("reaches 2 m"));
  CHECK_THAT(changed([](GrainScene& s) { s.clumps[0].discs[0].offset.x = -0.9; }), Contains("centre of mass at (0.05"));
  CHECK_THAT(changed([](GrainScene& s) { s.clumps[0].discs[0].radius = 0; }), Contains("disc of the radius 0"));
  CHECK_THAT(changed([](GrainScene& s) { s.clumps[0].discs.clear(); }), Contains("has no discs"));
  CHECK_THAT(changed([](GrainScene& s) { s.walls = {line("floor", {0, -0.5}, {1, 0})}; }), Contains("behind wall"));
}

TEST_CASE("an_interlocked_clump_may_start_in_the_hollow_of_another") {
  // centres of mass in one place, no disc in another
  GrainScene scene = scene_of({}, {}, {.stiffness = 100});
  std::vector<Clump::Disc> ring;
  for (int k = 0; k < 12; ++k)
    ring.push_back({{3 * std::cos(k * std::numbers::pi / 6), 3 * std::sin(k * std::numbers::pi / 6)}, 0.8});
  scene.grains = {lump(scene, ring, {0, 0}), lump(scene, pair_of_discs(), {0, 0}, 0.3, {1, 0.2})};
  GrainSimulation simulation(scene, options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 0.002));
  simulation.advance(10000);
  const std::vector<Grain> grains = simulation.grains();
  CAPTURE(simulation.counters().contacts, simulation.energy().error());
  CHECK(simulation.counters().contacts > 5);
  CHECK(norm(grains[1].position - grains[0].position) < 1.3);
  CHECK(std::abs(simulation.energy().error()) < 5e-4 * simulation.energy().initial);
}

TEST_CASE("effects_of_shapes_are_listed") {
  const GrainSimulation simulation(two(oval({0, 0}, 1, 0.5), oval({3, 0}, 1, 0.5)),
                                   options_of(NormalLaw::linear_dashpot, 0.01));
  bool found = false;
  for (const Effects::Entry& entry : simulation.effects().entries) {
    if (entry.name == "rotation") CHECK(entry.why == "normal forces turn ellipses and clumps");
    if (entry.name == "clumps") CHECK_FALSE(entry.active);
    found = found || (entry.name == "ellipses" && entry.active);
  }
  CHECK(found);
  CHECK(simulation.effects().rotation);
}

TEST_CASE("ellipses_that_would_pass_unseen_are_refused") {
  // a fast needle, a needle that turns fast, a clump shot through another
  GrainScene fast = two(oval({0, 0}, 1, 0.05, 1.5), oval({-0.3, 0.1}, 1, 0.05, 1.5, {60, 0}));
  GrainScene turning = two(oval({0, 0}, 1, 0.05), oval({1.1, 0.5}, 1, 0.05, 0.2));
  turning.grains[1].spin = 90;
  GrainScene clumps = scene_of({}, {}, {.stiffness = 100});
  clumps.grains = {lump(clumps, pair_of_discs(), {0, 0}, 1.5), lump(clumps, pair_of_discs(), {-2.1, 0}, 1.5, {500, 0})};
  for (const GrainScene& scene : {fast, turning, clumps}) {
    GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 0.01));
    const Bits before = bits_of(simulation);
    CHECK_THROWS_WITH(simulation.advance(1), Catch::Contains("pass through") && Catch::Contains("step 0"));
    CHECK(bits_of(simulation) == before);
    GrainOptions options = options_of(NormalLaw::linear_dashpot, 0.01);
    options.refuse_crossing = false;
    GrainSimulation free(scene, options);
    CHECK_NOTHROW(free.advance(5));
  }
}

TEST_CASE("needles_that_slide_past_one_another_are_not_refused") {
  // nearer than half the sum of their long half-axes, and changing sides
  GrainSimulation simulation(two(oval({-1.5, 0}, 1, 0.05, 0, {5, 0}), oval({1.5, 0.11}, 1, 0.05, 0, {-5, 0})),
                             options_of(NormalLaw::linear_dashpot, 0.01));
  CHECK_NOTHROW(simulation.advance(60));
  CHECK(simulation.counters().contacts == 0);
}
