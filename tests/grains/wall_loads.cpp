// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What bodies do to walls: forces, moments, impulses, works.
#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Impulse of all walls and works of them, added up.
std::pair<Vec2, double> sums_over_walls(const GrainSimulation& simulation) {
  Vec2 impulse;
  double work = 0;
  for (const WallState& wall : simulation.walls()) {
    impulse += wall.impulse;
    work += wall.work;
  }
  return {impulse, work};
}

}  // namespace

TEST_CASE("a_disc_at_rest_presses_the_floor_with_its_weight_at_the_arm_where_it_lies") {
  const Stepping stepping = GENERATE(from_range(servo_steppings));
  CAPTURE(stepping.name());
  Wall floor = line("floor", {0.25, 0}, {0, 1});
  PairProperties pair = one_second(stepping.law, 0.2);
  pair.stiffness *= 100;
  GrainSimulation simulation(scene_of({ball({1, 0.5}, 0.5)}, {floor}, pair, {0, -1}), options_of(stepping, 1e-3));
  simulation.advance(20000);
  const WallState state = simulation.walls().front();
  CHECK(state.name == "floor");
  CHECK(state.place == floor.point);
  CHECK(std::abs(state.force.y + 1) < 1e-9);
  CHECK(state.force.x == 0);
  CHECK(std::abs(state.moment + 0.75) < 1e-9);
  CHECK(state.work == 0);
}

TEST_CASE("what_walls_get_is_what_bodies_lose_and_their_works_are_that_of_the_ledger") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  CAPTURE(stepping.name());
  const GrainScene scene = busy_box(stepping.law, 4, 3, 7);
  GrainSimulation simulation(scene, options_of(stepping, 2e-3));
  double mass = 0;
  for (const Grain& grain : scene.grains) mass += grain.inertia.mass;
  const Vec2 at_start = momenta_of(simulation.grains()).linear;
  double size = 0;
  for (int k = 0; k < 20; ++k) {
    simulation.advance(100);
    const auto [impulse, work] = sums_over_walls(simulation);
    const Vec2 change = momenta_of(simulation.grains()).linear - at_start - (simulation.time() * mass) * scene.gravity;
    size = std::max(size, norm(impulse));
    CAPTURE(k, impulse.x, impulse.y, change.x, change.y);
    REQUIRE(norm(impulse + change) <= 1e-12 * std::max(1.0, size));
    const EnergyLedger ledger = simulation.energy();
    REQUIRE(std::abs(work - ledger.work_of_walls) <= 1e-12 * ledger.largest());
  }
  CHECK(size > 1);
}

TEST_CASE("a_piston_works_by_its_force_times_its_way") {
  const Stepping stepping = GENERATE(from_range(servo_steppings));
  CAPTURE(stepping.name());
  std::vector<Wall> walls{line("floor", {0, 0}, {0, 1}), line("lid", {0, 1}, {0, -1})};
  walls[1].move_y = {Schedule::Kind::ramp, -0.01, 0, 4};
  PairProperties pair = one_second(stepping.law, 0.5);
  pair.stiffness *= 100;
  GrainSimulation simulation(scene_of({ball({0, 0.5}, 0.5)}, walls, pair), options_of(stepping, 1e-3));
  double work = 0, place = 1;
  for (int k = 0; k < 4000; ++k) {
    simulation.advance(1);
    const WallState lid = simulation.walls()[1];
    work += -lid.force.y * (lid.place.y - place);
    place = lid.place.y;
  }
  const WallState lid = simulation.walls()[1];
  CAPTURE(work, lid.work);
  CHECK(lid.work > 0);
  CHECK(std::abs(work - lid.work) <= 1e-12 * lid.work);
  CHECK(lid.place.y == 1 - 0.01);
  CHECK(simulation.walls()[0].work == 0);
}
