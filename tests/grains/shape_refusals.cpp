// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Ellipses and clumps that cannot be stepped, and steps that would let them pass through one another.
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

GrainScene two(const Grain& a, const Grain& b) {
  return scene_of({a, b}, {}, {.stiffness = 100});
}

std::string refusal(const GrainScene& scene, NormalLaw law = NormalLaw::linear_dashpot) {
  try {
    check(scene, options_of(law, 0.01), [](std::size_t grain) { return "grain " + std::to_string(grain); });
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::bad_input);
    return error.what();
  }
  return "";
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

TEST_CASE("equal_ellipses_exactly_aligned_rebound_without_turning") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const bool along = GENERATE(true, false);
  const double reach = along ? 1 : 0.05;
  const Vec2 way = along ? Vec2{1, 0} : Vec2{0, 1};
  PairProperties pair = one_second(stepping.law, 1, 0.5);
  pair.stiffness *=
      1e7;  // overlaps stay below the sharpest radius of curvature, 0.0025: deeper, tips give way sideways
  GrainSimulation simulation(
      scene_of({oval(-reach * way, 1, 0.05, 0, way), oval((reach + 1e-5) * way, 1, 0.05, 0, -way)}, {}, pair),
      options_of(stepping, 1e-6));
  REQUIRE(pass_contact(simulation, 4000));
  const std::vector<Grain> grains = simulation.grains();
  CAPTURE(stepping.name(), along, norm(grains[0].velocity), grains[0].spin);
  CHECK(norm(grains[0].velocity + way) < 2e-2);
  CHECK(std::abs(grains[0].spin) < 1e-9);
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

TEST_CASE("a_grain_squeezed_through_a_closing_gap_is_refused") {
  const int shape = GENERATE(0, 1, 2);
  GrainScene scene =
      scene_of({}, {line("anvil", {0, 0}, {0, 1}), line("press", {0, 2.02}, {0, -1})}, {.stiffness = 100});
  scene.walls[1].move_y = {Schedule::Kind::table, 0, 0, 0, 0, {0, 100}, {0, -100}};
  scene.grains = {shape == 0   ? oval({0, 1.01}, 1.2, 1)
                  : shape == 1 ? lump(scene, {{{0, 0}, 1}, {{0.5, 0}, 0.9}}, {0, 1.01})
                               : ball({0, 1.01}, 1)};
  scene.grains.push_back(oval({5, 1}, 0.9, 0.3));
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 0.001));
  CHECK_THROWS_WITH(simulation.advance(5000), Catch::Contains("grain") && Catch::Contains("Use"));
  CHECK(simulation.time() > 0.5);
}

TEST_CASE("a_box_filled_past_its_volume_with_needles_keeps_numbers_or_is_refused") {
  GrainScene scene =
      scene_of({}, {line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}), line("right", {1, 0}, {-1, 0})},
               {.stiffness = 1e4, .restitution = 0.5}, {0, -10});
  for (int k = 0; k < 8; ++k) scene.grains.push_back(oval({0.5, 0.03 + 0.05 * k}, 0.52, 0.026, 0.01 * k));
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 1e-3));
  try {
    simulation.advance(2000);
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::computation_failed);
  }
  for (const Grain& grain : simulation.grains()) CHECK(std::isfinite(norm(grain.position) + grain.angle));
}

TEST_CASE("a_large_ellipse_meets_small_ones") {
  // radii 1:100
  GrainScene scene = scene_of({oval({0, -100}, 100, 99)}, {}, {.stiffness = 1e4});
  for (int k = -5; k <= 5; ++k)
    scene.grains.push_back(oval({2.5 * k, 1.2 - 0.5 * k * k * 0.063}, 1, 0.3, 0.1, {0, -1}));
  scene.grains[0].inertia = {1e4, 1e4 * (1e4 + 9801) / 4};
  GrainSimulation simulation(scene, options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 2e-4));
  simulation.advance(10000);
  CAPTURE(simulation.counters().contacts, simulation.energy().error());
  CHECK(simulation.counters().contacts >= 11);
  CHECK(std::abs(simulation.energy().error()) < 1e-3 * simulation.energy().initial);
}
