// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What a hostile user found.
#include <cmath>

#include "equidem/grains/scene/wall_joints.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Wall segment(std::string name, Vec2 point, Vec2 end) {
  Wall wall = line(std::move(name), point, {0, 1});
  wall.shape = Wall::Shape::segment;
  wall.end = end;
  return wall;
}

GrainSimulation simulation_of(const std::vector<Grain>& grains, const std::vector<Wall>& walls, double stiffness,
                              double step, const Stepping& stepping, Vec2 gravity = {}) {
  GrainScene scene;
  scene.grains = grains;
  scene.walls = walls;
  scene.gravity = gravity;
  scene.pairs = {{.stiffness = stiffness, .restitution = 0.6}};
  return {scene, {.law = stepping.law, .integrator = stepping.integrator, .time_step = step}};
}

}  // namespace

TEST_CASE("what_is_too_soft_to_hold_a_body_is_refused_however_short_the_steps") {
  for (const Stepping& stepping : all_steppings) {
    if (is_map(stepping.law)) continue;  // they turn any speed round
    CAPTURE(stepping.name());
    const auto refused = [&](const std::vector<Grain>& grains, const std::vector<Wall>& walls) {
      GrainSimulation simulation = simulation_of(grains, walls, 1e-3, 1e-3, stepping);
      try {
        simulation.advance(4000);
      } catch (const Error& error) {
        INFO(error.what());
        CHECK(error.remedy().find("stiffer") != std::string::npos);
        CHECK(error.remedy().find("Use a step below") == std::string::npos);
        return true;
      }
      return false;
    };
    CHECK(refused({ball({0, 1.01}, 1, {0, -1})}, {line("floor", {0, 0}, {0, 1})}));
    CHECK(refused({ball({0, 1.01}, 1, {0, -1})}, {segment("plate", {-3, 0}, {3, 0})}));
    CHECK(refused({ball({0, 0}, 1, {1, 0}), ball({2.01, 0.1}, 1)}, {}));  // not head-on: they would go round each other
  }
}

TEST_CASE("a_body_that_hits_the_joint_of_two_walls_rebounds_as_from_one") {
  const std::vector<std::vector<Wall>> joints{{segment("a", {-3, 0}, {0, 0}), segment("b", {0, 0}, {3, 0})},
                                              {segment("b", {0, 0}, {3, 0}), segment("a", {0, 0}, {-3, 0})},
                                              {segment("a", {-3, -3}, {0, 0}), segment("b", {0, 0}, {3, -3})},
                                              {line("floor", {0, 0}, {0, 1}), segment("post", {0, 0}, {0, -3})}};
  for (const Stepping& stepping : all_steppings) {
    const auto rebound = [&](const std::vector<Wall>& walls) {
      GrainSimulation simulation = simulation_of({ball({0, 1.01}, 1, {0, -1})}, walls, 1e4, 1e-3, stepping);
      simulation.advance(100);
      CHECK(simulation.counters().contacts == 1);
      return simulation.grains()[0].velocity.y;
    };
    const double alone = rebound({segment("one", {-3, 0}, {3, 0})});
    for (const auto& walls : joints) {
      CAPTURE(stepping.name(), walls[0].name, walls[1].end.x);
      CHECK(rebound(walls) == Approx(alone).epsilon(1e-12));
    }
  }
}

TEST_CASE("a_body_slides_over_the_joints_of_a_floor_as_over_a_whole_one") {
  // Pressed in by its weight, a body that met the next piece before its time would be lifted and slowed there. What is
  // left is the step in which it comes to the next piece: its contact is still with the end of the last one.
  std::vector<Wall> pieces;
  for (int k = 0; k < 10; ++k) pieces.push_back(segment("piece", {0.5 * k, 0}, {0.5 * (k + 1), 0}));
  const double stiffness = 1e4, step = 1e-3;
  const Grain start = ball({0.2, 1 - 9.8 / stiffness}, 1, {1, 0});
  for (const Stepping& stepping : all_steppings) {
    CAPTURE(stepping.name());
    if (stepping.law == NormalLaw::hertz_dashpot) continue;  // rests elsewhere
    GrainSimulation whole =
        simulation_of({start}, {segment("one", {0, 0}, {5, 0})}, stiffness, step, stepping, {0, -9.8});
    GrainSimulation joined = simulation_of({start}, pieces, stiffness, step, stepping, {0, -9.8});
    whole.advance(3500);
    joined.advance(3500);
    CAPTURE(whole.grains()[0].velocity.x, whole.grains()[0].position.y);
    CHECK(joined.grains()[0].velocity.x == Approx(whole.grains()[0].velocity.x).epsilon(2e-3));
    CHECK(joined.grains()[0].position.y == Approx(whole.grains()[0].position.y).epsilon(1e-4));
  }
}

TEST_CASE("walls_that_lie_on_one_another_are_refused") {
  const Wall floor = line("floor", {0, 0}, {0, 1}), plate = segment("plate", {0, 0}, {1, 0});
  const std::vector<std::vector<Wall>> doubled{{floor, line("again", {5, 0}, {0, 1})},
                                               {plate, segment("again", {1, 0}, {0, 0})},
                                               {plate, segment("part", {0.5, 0}, {2, 0})},
                                               {plate, segment("half", {0, 0}, {0.5, 0})},
                                               {floor, plate}};
  const std::vector<std::vector<Wall>> apart{{floor, line("roof", {0, 0}, {0, -1})},
                                             {plate, segment("next", {1, 0}, {2, 0})},
                                             {plate, segment("corner", {0, 0}, {0, 1})},
                                             {plate, segment("cross", {0.5, -1}, {0.5, 1})},
                                             {floor, segment("post", {0, 0}, {0, 1})}};
  for (const auto& walls : doubled) {
    CAPTURE(walls[0].name, walls[1].name);
    CHECK(coinciding_walls(walls, 1e-6).has_value());
  }
  for (const auto& walls : apart) {
    CAPTURE(walls[0].name, walls[1].name);
    CHECK_FALSE(coinciding_walls(walls, 1e-6).has_value());
  }
  CHECK_THROWS_AS(simulation_of({ball({0, 2}, 1)}, doubled[0], 1, 0.1, {}), Error);
}

TEST_CASE("five_case_map_is_limited_by_bodies_that_meet") {
  // one grain and a wall: a = k dt²/m, not of two such grains; e >= sqrt(a/(1 + a))
  GrainScene scene;
  scene.grains = {ball({0, 2}, 1)};
  scene.walls = {line("floor", {0, 0}, {0, 1})};
  scene.pairs = {{.stiffness = 0.1, .restitution = std::sqrt(0.1 / 1.1) + 1e-9}};
  const GrainOptions options{.law = NormalLaw::five_case_map, .time_step = 1};
  CHECK_NOTHROW(check(scene, options));
  scene.grains.push_back(ball({5, 2}, 1));
  CHECK_THROWS_AS(check(scene, options), Error);
}

TEST_CASE("numbers_whose_squares_are_none_are_refused_where_they_stand") {
  GrainScene scene;
  scene.pairs = {{.stiffness = 1}};
  const GrainOptions options{.time_step = 1e-3};
  for (const Grain& grain : {ball({0, 2}, 1, {0, -1e200}), ball({1e300, 2}, 1), ball({0, 2}, 1e170)}) {
    scene.grains = {ball({0, -2}, 1), grain};
    CAPTURE(grain.position.x, grain.radius, grain.velocity.y);
    try {
      check(scene, options, [](std::size_t i) { return "line " + std::to_string(i); });
      FAIL("accepted");
    } catch (const Error& error) {
      CHECK(error.where() == "line 1");
    }
  }
}
