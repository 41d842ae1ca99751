// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Relaxation under weight and walls, at a time, on any number of threads, and what it refuses.
#include "equidem/dynamics/relaxation.hpp"

#include <cstring>

#include "dynamics/moving_scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("weight_on_a_floor_relaxes_to_the_weight_over_the_spring") {
  const Assembly column = [] {
    Assembly one = chain_of_discs(3, 0.5);
    for (Vec2& x : one.centres) x = {0, x.x};
    return with_each_disc_named(one);
  }();
  const ContactSprings springs(SpringConstants{100, 0});
  TimedSupport guide;
  guide.group = "0";
  guide.ux = always(0);
  std::vector<TimedSupport> guides(3, guide);
  guides[1].group = "1";
  guides[2].group = "2";
  equidem::Scene scene(column, springs, {{1, 1}, {2, 1}, {3, 1}});
  scene.supports = guides;
  scene.walls = {{.name = "floor", .point = {0, -0.5}, .normal = {0, 1}, .kN = 50}};
  scene.gravity = {0, -1};
  const auto motion = GENERATE(LoopKind::Motion::small, LoopKind::Motion::finite);
  const Relaxation rest = relax(scene, {.motion = motion, .tolerance = 1e-12});
  CAPTURE(rest.report());
  CHECK(rest.motions[0].u.y == Approx(-6.0 / 50).epsilon(1e-11));
  CHECK(rest.motions[1].u.y == Approx(-6.0 / 50 - 5.0 / 100).epsilon(1e-11));
  CHECK(rest.motions[2].u.y == Approx(-6.0 / 50 - 5.0 / 100 - 3.0 / 100).epsilon(1e-11));
}

TEST_CASE("one_disc_above_a_floor_falls_to_its_rest_on_it") {
  Assembly alone;
  alone.kind = "file";
  alone.centres = {{0, 2}};
  alone.radii = {0.5};
  const ContactSprings springs(SpringConstants{1, 0.5});
  equidem::Scene scene(alone, springs, {{1, 1}});
  scene.walls = {{.name = "floor", .point = {0, 0}, .normal = {0, 1}, .kN = 50}};
  const auto motion = GENERATE(LoopKind::Motion::small, LoopKind::Motion::finite);
  CHECK(relax(scene, {.motion = motion}).relative_unbalanced == 0);
  CHECK(relax(scene, {.motion = motion}).report().find("no force is left unbalanced") != std::string::npos);
  if (motion == LoopKind::Motion::finite) {
    scene.gravity = {0, -1};
    const Relaxation rest = relax(scene, {.motion = motion, .tolerance = 1e-12});
    CAPTURE(rest.report());
    CHECK(rest.motions[0].u.y == Approx(-1.5 - 1.0 / 50).epsilon(1e-11));
    CHECK(rest.relative_unbalanced <= 1e-12);
  }
  // Nothing hinders it sideways, and nothing carries what acts there.
  scene.gravity = {1, 0};
  const Refusal falls = refusal_of([&] { (void)relax(scene, {.motion = motion, .max_steps = 50}); });
  CAPTURE(falls.message);
  CHECK(falls.says("no contact and no wall carries"));
}

TEST_CASE("the_unbalanced_force_is_relative_to_all_forces") {
  const Assembly pair = chain_of_discs(2, 0.5);
  const ContactSprings springs(SpringConstants{3, 0});
  const equidem::Scene scene(pair, springs, {{1, 1}, {1, 1}});
  const auto relative = [&](double stretch, double left) {
    return relative_unbalanced_force(scene, LoopKind::Motion::small, {{{left, 0}, 0}, {}}, {{}, {{stretch, 0}, 0}});
  };
  CHECK(relative(0, 0) == 0);
  CHECK(relative(0, 2) == 1);
  CHECK(relative(1, 0) == 0);
  CHECK(relative(1, 4) == Approx(0.8).epsilon(1e-14));  // 3, 4, 5
}

TEST_CASE("what_finds_no_rest_says_so") {
  const Assembly assembly = hexagonal_block(4);
  const ContactSprings springs(SpringConstants{1, 0.5}), pushing(SpringConstants{1, -0.2});
  equidem::Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  scene.loads = lasting({{"right", LoadKind::per_disc, {0.1, 0.1}, 0}});
  CHECK(refusal_of([&] { (void)relax(scene, {.tolerance = 0}); }).says("unbalanced force wanted is 0"));
  CHECK(refusal_of([&] { (void)relax(scene, {.max_steps = 0}); }).says("largest number of steps is 0"));
  CHECK(refusal_of([&] { (void)relax(scene, {.start = std::vector<DiscMotion>(2)}); }).says("2 discs"));
  CHECK(refusal_of([&] { (void)relax(scene, {.max_steps = 500}); }).kind == ErrorKind::computation_failed);
  scene.supports = held_still(assembly, std::vector<Support>{{"left", 0.0, 0.0, {}}});
  CHECK(refusal_of([&] { (void)relax(scene, {.tolerance = 1e-12, .max_steps = 3}); }).says("after 3 steps"));
  equidem::Scene unstable(assembly, pushing, scene.inertia);
  unstable.supports = scene.supports;
  unstable.loads = scene.loads;
  CHECK(refusal_of([&] { (void)relax(unstable, {}); }).says("kT is negative"));
  CHECK(refusal_of([&] { (void)relax(scene, {.tolerance = 1e-11}); }).message.empty());
  CHECK(refusal_of([&] { (void)relax(scene, {.tolerance = 1e-20}); }).says("rounding of the displacements"));
}

TEST_CASE("rest_at_a_time_is_that_of_loads_and_supports_then") {
  const Assembly assembly = delaunay_block(40, 2);
  const ContactSprings springs(SpringConstants{1, 0.5});
  TimedSupport bottom;
  bottom.group = "bottom";
  bottom.ux = always(0);
  bottom.uy = Schedule{.kind = Schedule::Kind::sine, .value = 0.01, .frequency = 0.1};
  equidem::Scene scene(assembly, springs, {});
  scene.supports = {bottom};
  scene.loads = {{{"top", LoadKind::per_disc, {0.01, 0}, 0}, {.kind = Schedule::Kind::ramp, .value = 1, .end = 4}}};
  const double time = GENERATE(0.0, 1.3, 6.0);
  const Relaxation then = relax(scene, {.time = time, .tolerance = 1e-11});
  equidem::Scene still = scene;
  still.supports[0].uy = always(bottom.uy->at(time));
  still.loads[0].factor = always(scene.loads[0].factor.at(time));
  const Relaxation same = relax(still, {.tolerance = 1e-11});
  CAPTURE(time, then.report());
  for (std::size_t d = 0; d < assembly.size(); ++d) CHECK(then.motions[d].u == same.motions[d].u);
  CHECK(then.motions[group(assembly, "bottom").discs[0]].u.y == Approx(bottom.uy->at(time)).margin(1e-18));
}

TEST_CASE("the_bits_of_rest_do_not_depend_on_threads") {
  const auto motion = GENERATE(LoopKind::Motion::small, LoopKind::Motion::finite);
  const Assembly assembly = delaunay_block(500, 2);
  const ContactSprings springs(SpringConstants{1, 0.5});
  equidem::Scene scene(assembly, springs, {});
  scene.supports = held_still(assembly, std::vector<Support>{{"bottom", 0.0, 0.0, {}}});
  scene.loads = lasting({{"top", LoadKind::per_disc, {0.001, 0.001}, 0}});
  std::vector<DiscMotion> first;
  for (const int threads : {1, 2, 7}) {
    const ThreadsFor here(threads);
    const Relaxation rest = relax(scene, {.motion = motion});
    if (threads == 1) first = rest.motions;
    CHECK(std::memcmp(first.data(), rest.motions.data(), first.size() * sizeof first[0]) == 0);
  }
}

TEST_CASE("a_start_at_rest_takes_no_step") {
  const Assembly assembly = hexagonal_block(5);
  const ContactSprings springs(SpringConstants{1, 0.5});
  equidem::Scene scene(assembly, springs, {});
  scene.supports = held_still(assembly, std::vector<Support>{{"bottom", 0.0, 0.0, {}}});
  scene.loads = lasting({{"top", LoadKind::per_disc, {0.001, 0.001}, 0}});
  const Relaxation rest = relax(scene, {.tolerance = 1e-11});
  CHECK(rest.steps > 0);
  CHECK(relax(scene, {.tolerance = 1e-10, .start = rest.motions}).steps == 0);
}
