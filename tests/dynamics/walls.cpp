// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/dynamics/scene_check.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

struct Extent {
  Vec2 low, high;  // of the centres
};

Extent extent_of(const Assembly& assembly) {
  Extent e{assembly.centres[0], assembly.centres[0]};
  for (const Vec2 x : assembly.centres) {
    e.low = {std::min(e.low.x, x.x), std::min(e.low.y, x.y)};
    e.high = {std::max(e.high.x, x.x), std::max(e.high.y, x.y)};
  }
  return e;
}

/// Four walls that touch the outermost discs.
std::vector<Wall> box_around(const Assembly& assembly) {
  const auto [low, high] = extent_of(assembly);
  const double a = assembly.radii[0];
  return {{.name = "left", .point = {low.x - a, 0}, .normal = {1, 0}, .kN = 1},
          {.name = "right", .point = {high.x + a, 0}, .normal = {-1, 0}, .kN = 1},
          {.name = "bottom", .point = {0, low.y - a}, .normal = {0, 1}, .kN = 1},
          {.name = "top", .point = {0, high.y + a}, .normal = {0, -1}, .kN = 1}};
}

std::string refusal(const std::vector<Wall>& walls, const Assembly& assembly) {
  try {
    for (std::size_t k = 0; k < walls.size(); ++k) check_wall(walls, k, assembly);
  } catch (const Error& error) {
    return error.kind() == ErrorKind::bad_input ? error.what() : "wrong kind";
  }
  return {};
}

const Assembly& block() {
  static const Assembly assembly = hexagonal_lattice({.columns = 5, .rows = 5, .radius = 0.5});
  return assembly;
}

}  // namespace

TEST_CASE("a_box_around_the_discs_stands_whichever_way_it_is_turned") {
  const std::vector<Wall> box = box_around(block());
  for (const double angle : {0.0, 0.3, 1.0, 2.5}) {
    CAPTURE(angle);
    const Vec2 e{std::cos(angle), std::sin(angle)};
    const auto turned = [&](Vec2 v) { return v.x * e + v.y * perpendicular(e); };
    Assembly assembly = block();
    for (Vec2& centre : assembly.centres) centre = turned(centre);
    std::vector<Wall> walls = box;
    for (Wall& wall : walls) {
      wall.point = turned(wall.point);
      wall.normal = turned(wall.normal);
    }
    CHECK(refusal(walls, assembly).empty());
  }
}

TEST_CASE("walls_that_face_each_other_with_no_room_between_them_cross") {
  std::vector<Wall> walls = box_around(block());
  std::swap(walls[0].point, walls[1].point);
  const std::string sentence = refusal(walls, block());
  CAPTURE(sentence);
  CHECK(sentence.find("'left' and 'right' cross") != std::string::npos);
}

TEST_CASE("moving_walls_cross_when_their_ways_add_up_to_the_room_between_them") {
  const auto [low, high] = extent_of(block());
  const double room = high.x - low.x + 2 * block().radii[0];
  const auto pressing = [&](double left, double right) {
    std::vector<Wall> walls = box_around(block());
    move_along(walls[0], {1, 0}, {.kind = Schedule::Kind::ramp, .value = left, .end = 0.2});
    move_along(walls[1], {-1, 0}, {.kind = Schedule::Kind::table, .times = {0, 0.1, 0.3}, .values = {0, 0, right}});
    return refusal(walls, block());
  };
  CHECK(pressing(0.5 * room, 0.49 * room).empty());
  const std::string sentence = pressing(0.5 * room, 0.51 * room);
  CAPTURE(sentence);
  CHECK(sentence.find("cross at 0.3 s") != std::string::npos);
  CHECK(pressing(2 * room, -1.5 * room).find("cross at 0.2 s") != std::string::npos);
}

TEST_CASE("a_box_that_is_shaken_as_a_whole_keeps_its_room") {
  std::vector<Wall> walls = box_around(block());
  const double amplitude = 100 * block().radii[0];
  const Schedule sine{.kind = Schedule::Kind::sine, .value = amplitude, .frequency = 2};
  move_along(walls[0], {1, 0}, sine);
  move_along(walls[1], {1, 0}, sine);
  CHECK(refusal(walls, block()).empty());
  move_along(walls[1], {-1, 0}, sine);
  CHECK(refusal(walls, block()).find("cross at 0.125 s") != std::string::npos);
}

TEST_CASE("two_walls_may_cross_as_a_corner_with_the_discs_inside_and_not_through_them") {
  std::vector<Wall> walls = box_around(block());
  walls.resize(3);
  walls.erase(walls.begin() + 1);
  REQUIRE(refusal(walls, block()).empty());
  walls[1].normal = {0, -1};
  const std::string behind = refusal(walls, block());
  CAPTURE(behind);
  CHECK(behind.find("behind wall 'bottom'") != std::string::npos);
  walls[1].normal = {std::sqrt(0.5), std::sqrt(0.5)};
  walls[1].point = block().centres[block().size() / 2];
  const std::string through = refusal(walls, block());
  CAPTURE(through);
  CHECK(through.find("behind wall 'bottom'") != std::string::npos);
}

TEST_CASE("walls_that_mean_nothing_are_refused") {
  const Wall good = box_around(block())[0];
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [&](auto change) {
    Wall wall = good;
    change(wall);
    return refusal({wall}, block());
  };
  REQUIRE(with([](Wall&) {}).empty());
  CHECK(with([](Wall& w) { w.kN = 0; }).find("the kN of wall") != std::string::npos);
  CHECK(with([&](Wall& w) { w.kN = nan; }).find("is nan Pa") != std::string::npos);
  CHECK(with([](Wall& w) { w.normal = {2, 0}; }).find("no unit vector") != std::string::npos);
  CHECK(with([](Wall& w) { w.normal = {0, 0}; }).find("no unit vector") != std::string::npos);
  CHECK(with([&](Wall& w) { w.point.y = nan; }).find("stands nowhere") != std::string::npos);
  CHECK(with([&](Wall& w) { w.move_x.value = nan; }).find("value of a schedule is nan") != std::string::npos);
  CHECK(with([](Wall& w) { w.shape = Wall::Shape::segment; }).find("straight walls alone") != std::string::npos);
  const Assembly periodic = hexagonal_lattice({.columns = 4, .rows = 4, .radius = 0.5, .periodic = true});
  CHECK(refusal({good}, periodic).find("periodic assembly") != std::string::npos);
}

TEST_CASE("a_disc_rebounds_from_a_wall_however_far_it_was") {
  const auto motion = GENERATE(LoopKind::Motion::small, LoopKind::Motion::finite);
  const double radii = GENERATE(0.5, 10.0, 1000.0);  // of the disc, from it to the wall
  Assembly assembly;
  assembly.centres = {{0, 0}};
  assembly.radii = {1};
  assembly.groups["all"] = {{0}, {}};
  const ContactSprings springs(SpringConstants{1, 0});
  Scene scene(assembly, springs, {{1, 1}});
  scene.velocities = {{"all", {1, 0}, 0}};
  scene.walls = {{.name = "far", .point = {1 + radii, 0}, .normal = {-1, 0}, .kN = 1e4}};
  const double step = 1e-3;
  Simulation run(scene, {.motion = motion, .time_step = step});
  run.advance(std::llround(1.5 * radii / step));
  CAPTURE(static_cast<int>(motion), radii, run.motions()[0].u.x, run.energy().error());
  // Half a period of contact is 0.03; contact from the middle of a step changes the speed by up to (omega h)²/8.
  CHECK(run.motions()[0].u.x == Approx(radii / 2).epsilon(2.5e-3).margin(0.04));
  CHECK(run.velocities()[0].u.x == Approx(-1).epsilon(1.3e-3));
}
