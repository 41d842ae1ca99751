// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What a hostile user found.
#include <cmath>

#include "equidem/grains/scene/wall_joints.hpp"

#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

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
      const Refusal refusal = refusal_of([&] { simulation.advance(4000); });
      INFO(refusal.message);
      CHECK(refusal.remedy.find("stiffer") != std::string::npos);
      CHECK(refusal.remedy.find("Use a step below") == std::string::npos);
      return !refusal.message.empty();
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
    const auto line_of = [](std::size_t i) { return "line " + std::to_string(i); };
    CHECK(refusal_of([&] { check(scene, options, line_of); }).where == "line 1");
  }
}

namespace {

struct Passage {
  double least = INFINITY, most = 0;  // force on the walls over the weight
  double lowest = INFINITY, highest = -INFINITY;
  Vec2 end;
};

/// A disc of the radius 2e-3 that rests on a floor with an overlap of a thousandth of it and moves along.
Passage pass(const std::vector<Wall>& walls, const Stepping& stepping, Vec2 start = {-2e-4, 2e-3 - 2e-6},
             Vec2 velocity = {0.25, 0}, double duration = 6e-3) {
  const double weight = 9.81, stiffness = weight / 2e-6, step = 2e-6;
  GrainScene scene =
      scene_of({ball(start, 2e-3, velocity)}, walls, {.stiffness = stiffness, .restitution = 1}, {0, -weight});
  GrainSimulation simulation(scene, options_of(stepping, step));
  Passage passage;
  for (int k = 0; k < duration / step; ++k) {
    simulation.advance(1);
    Vec2 force;
    for (const WallState& wall : simulation.walls()) force += wall.force;
    passage.least = std::min(passage.least, norm(force) / weight);
    passage.most = std::max(passage.most, norm(force) / weight);
    passage.end = simulation.motions()[0].u;
    passage.lowest = std::min(passage.lowest, passage.end.y);
    passage.highest = std::max(passage.highest, passage.end.y);
  }
  return passage;
}

}  // namespace

TEST_CASE("a_disc_passes_ends_of_walls_that_nearly_meet_as_one_wall") {
  // gaps, overlaps, steps up and down, of 1e-13 to 2e-3 of the radius; the floor of one piece is what is right
  const Stepping stepping = GENERATE(Stepping{NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet},
                                     Stepping{NormalLaw::linear_dashpot, GrainIntegrator::semi_implicit_euler});
  const Passage whole = pass({segment("one", {-0.05, 0}, {0.05, 0})}, stepping);
  for (const double gap : {1e-16, 3e-12, 1e-9, 3e-8, 3e-7, 3e-6, -3e-8, -3e-7, -3e-6}) {
    for (const double rise : {0.0, 0.1, -0.1}) {
      const Vec2 from{gap, rise * std::abs(gap)};
      const std::vector<std::vector<Wall>> floors{
          {segment("a", {-0.05, 0}, {0, 0}), segment("b", from, {0.05, 0})},
          {segment("b", {0.05, 0}, from), segment("a", {0, 0}, {-0.05, 0})},
          {segment("a", {-0.05, 0}, {0, 0}), segment("b", from, {0.05, 0}), segment("post", -from, {0, -0.05})}};
      for (const auto& floor : floors) {
        const Passage parts = pass(floor, stepping);
        CAPTURE(stepping.name(), gap, rise, floor.size(), parts.least, parts.most, parts.lowest, parts.highest);
        CHECK(gaps_of_walls(floor, 2e-3).empty());
        // of a step the first wall takes half
        const double margin = 1e-3 + 0.6 * std::abs(rise * gap) / 2e-6;
        CHECK(std::abs(parts.least - whole.least) < margin);
        CHECK(std::abs(parts.most - whole.most) < margin);
        const double height = 2e-9 + 1.2 * std::abs(rise * gap);
        CHECK(std::abs(parts.lowest - whole.lowest) < height);
        CHECK(std::abs(parts.highest - whole.highest) < height);
      }
    }
  }
}

TEST_CASE("corners_of_ends_that_nearly_meet_act_as_corners") {
  // over a ridge, through a notch, over kinks so slight that both walls are met in nearly one point
  const Stepping stepping{NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet};
  for (const double slope : {-0.3, -0.01, -1e-3, -1e-5, 1e-7, 1e-5, 1e-4}) {
    const Vec2 end{0.05, 0.05 * slope};
    const Passage exact = pass({segment("a", {-0.05, 0}, {0, 0}), segment("b", {0, 0}, end)}, stepping);
    // up to a twentieth of the overlap, half of which the first wall takes
    for (const Vec2 from : {Vec2{1e-6, 0}, Vec2{-1e-6, 0}, Vec2{-1e-6, 1e-7}, Vec2{0, -1e-7}}) {
      const Passage typed = pass({segment("a", {-0.05, 0}, {0, 0}), segment("b", from, end)}, stepping);
      CAPTURE(slope, from.x, from.y, exact.most, typed.most, exact.end.y, typed.end.y);
      CHECK(typed.most == Approx(exact.most).epsilon(4e-2));
      CHECK(typed.end.y == Approx(exact.end.y).margin(1e-6));
    }
    if (std::abs(slope) <= 1e-5) CHECK(exact.most == Approx(1).epsilon(5e-3));
  }
}

TEST_CASE("only_walls_that_move_alike_join_and_gaps_of_others_stay") {
  const std::vector<Wall> still{segment("a", {-1, 0}, {0, 0}), segment("b", {1e-5, 0}, {1, 0})};
  CHECK(joined_walls(still, 1e-4)[0].end == joined_walls(still, 1e-4)[1].point);
  CHECK(joined_walls(still, 1e-6)[0].end == still[0].end);
  std::vector<Wall> moving = still;
  moving[1].move_x = {Schedule::Kind::sine, 0.2, 0, 0, 0.5};
  CHECK(joined_walls(moving, 1e-4)[1].point == still[1].point);
  CHECK(joints_of(moving, 1e-4).empty());
  std::vector<Wall> pushed = still;
  pushed[1].servo.emplace();
  CHECK(joints_of(pushed, 1e-4).empty());
  // short walls keep their lengths, whatever the bodies are
  const std::vector<Wall> fine{segment("a", {0, 0}, {1e-5, 0}), segment("b", {1e-5, 0}, {2e-5, 0})};
  const std::vector<Wall> kept = joined_walls(fine, 1e-4);
  for (std::size_t k = 0; k < 2; ++k) CHECK((kept[k].point == fine[k].point && kept[k].end == fine[k].end));
  CHECK(joints_of(fine, 1e-4)[0][1].size() == 1);
}

TEST_CASE("ends_a_little_too_far_apart_to_join_are_named_with_their_distance") {
  const std::vector<Wall> walls{segment("left half", {-1, 0}, {0, 0}), segment("right half", {0.005, 0}, {1, 0})};
  const std::vector<std::string> sentences = gaps_of_walls(walls, 0.1);
  REQUIRE(sentences.size() == 1);
  INFO(sentences[0]);
  for (const char* word : {"left half", "right half", "0.005 m apart, 0.05 of"})
    CHECK(sentences[0].find(word) != std::string::npos);
  CHECK(gaps_of_walls(walls, 0.01).empty());  // a slot
  CHECK(gaps_of_walls(walls, 1).empty());     // they join
}

TEST_CASE("an_ellipse_slides_over_a_joint_of_segments_as_over_one") {
  // Where walls join, one contact: the floor in two pieces is as stiff as in one.
  const bool clump = GENERATE(false, true);
  const auto run = [&](const std::vector<double>& ends) {
    GrainScene scene = scene_of({}, {}, {.stiffness = 1e4}, {0, -1});
    scene.grains = {clump ? lump(scene, pair_of_discs(), {-3, 1 - 1e-5}, 0, {1, 0})
                          : oval({-3, 0.5}, 1, 0.5, 0.1, {1, 0})};
    for (std::size_t k = 0; k + 1 < ends.size(); ++k)
      scene.walls.push_back(segment(std::to_string(k), {ends[k], 0}, {ends[k + 1], 0}));
    GrainSimulation simulation(scene, options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 1e-3));
    simulation.advance(6000);
    CHECK(simulation.grains()[0].position.x > 2.9);
    return simulation.grains()[0];
  };
  const Grain whole = run({-20, 20}), pieces = run({-20, 0, 1, 20});
  CAPTURE(clump, whole.position.y, pieces.position.y, whole.angle, pieces.angle);
  CHECK(norm(whole.position - pieces.position) < 1e-9);
  CHECK(std::abs(whole.angle - pieces.angle) < 1e-9);
}
