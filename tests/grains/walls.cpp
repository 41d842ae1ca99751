// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Walls: what bodies do to them, boxes that are shaken, walls that follow a force or a stress.
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"
#include "equidem/motion/wall.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

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

namespace {

using std::numbers::pi;

double speed(const Schedule& s, double t, double h = 1e-6) {
  return (s.at(t + h) - s.at(t - h)) / (2 * h);
}
double acceleration(const Schedule& s, double t, double h = 1e-4) {
  return (s.at(t + h) - 2 * s.at(t) + s.at(t - h)) / (h * h);
}

}  // namespace

TEST_CASE("the_box_has_the_acceleration_asked_for") {
  for (const double wanted : {0.01, 4.0, 1e3}) {
    const Schedule s = harmonic_shaking(wanted, 10, 0.3, 5);
    double most = 0;
    for (double t = 0.301; t < 0.799; t += 0.001) {
      CAPTURE(wanted, t);
      CHECK(acceleration(s, t) == Approx(wanted * std::cos(20 * pi * (t - 0.3))).margin(2e-5 * wanted));
      most = std::max(most, std::abs(acceleration(s, t)));
    }
    CHECK(most == Approx(wanted).epsilon(1e-4));
    CHECK(s.at(0.3) == 0);
    CHECK(s.at(1) == 0);
    for (const double end : {0.3, 0.8}) CHECK(std::abs(speed(s, end)) < 1e-5 * wanted);
  }
}

TEST_CASE("shakings_without_a_meaning_are_refused") {
  CHECK_THROWS_AS(harmonic_shaking(4, 0, 0, 5), Error);
  CHECK_THROWS_AS(harmonic_shaking(4, 10, 0, 0), Error);
  std::vector<Wall> walls{line("floor", {}, {0, 1})};
  shake(walls, {1, 0}, harmonic_shaking(4, 10, 0, 5));
  CHECK(walls[0].moves());
  CHECK_FALSE(walls[0].move_y.changes());
  CHECK_THROWS_AS(shake(walls, {1, 0}, harmonic_shaking(4, 10, 0, 5)), Error);
}

TEST_CASE("a_grain_that_friction_holds_follows_the_box_and_one_that_it_cannot_hold_stays_behind") {
  // Tangential springs hold while mu g > a (a block, not a roller: the spin meets a moment of inertia beyond all).
  for (const double acceleration : {2.0, 8.0}) {
    Grain block = ball({0, 0.01}, 0.01, {}, 0.5);
    block.inertia.moment = 1e6;
    PairProperties pair{
        .stiffness = 1e6, .restitution = 0.2, .friction = 0.5, .tangential_ratio = 0.5, .tangential_damping = 0.3};
    std::vector<Wall> walls{line("floor", {}, {0, 1})};
    shake(walls, {1, 0}, harmonic_shaking(acceleration, 5, 0.1, 4));
    GrainSimulation simulation(scene_of({block}, walls, pair, {0, -9.81}), options_of(NormalLaw::exact_flow, 2e-5));
    double behind = 0;
    while (simulation.time() < 1) {
      simulation.advance(100);
      behind = std::max(behind, std::abs(simulation.grains()[0].position.x - walls[0].move_x.at(simulation.time())));
    }
    CAPTURE(acceleration, behind);
    if (acceleration < 0.5 * 9.81) {
      CHECK(behind < 1e-5);
    } else {
      CHECK(behind > 1e-3);
    }
  }
}

TEST_CASE("a_servo_wall_holds_its_force_and_the_floor_bears_it") {
  const Stepping stepping = GENERATE(from_range(servo_steppings));
  CAPTURE(stepping.name());
  const GrainScene scene = pressed_columns(stepping.law, 20, 0.3);
  GrainSimulation simulation(scene, options_of(stepping, 2e-4));
  simulation.advance(200000);
  const auto walls = simulation.walls();
  const ServoReport report = simulation.servos().front();
  CAPTURE(report.present, report.overshoot, report.mean_error, walls[0].force.y);
  CHECK(report.wall == "lid");
  CHECK(report.reached);
  CHECK(report.wanted == 20);
  CHECK(std::abs(walls[3].force.y - 20) < 1e-6 * 20);
  CHECK(std::abs(walls[0].force.y + 20) < 1e-4 * 20);
  CHECK(report.mean_error < 0.02);
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(ledger.error(), ledger.largest(), ledger.work_of_walls, walls[3].work);
  CHECK(std::abs(ledger.error()) < 0.02 * ledger.largest());
  CHECK(std::abs(walls[3].work - ledger.work_of_walls) <= 1e-12 * ledger.largest());
  CHECK(walls[3].work > 0);
}

TEST_CASE("walls_tied_as_mirrors_move_alike_and_the_mean_of_their_forces_is_held") {
  const Stepping stepping = GENERATE(from_range(servo_steppings));
  CAPTURE(stepping.name());
  GrainScene scene = pressed_columns(stepping.law, 20);
  scene.walls[0].servo = Servo{.direction = {0, 1}, .wanted = {.value = 10}, .max_speed = 0.1, .mirror = "lid"};
  scene.walls[3].servo.reset();
  GrainSimulation simulation(scene, options_of(stepping, 2e-4));
  simulation.advance(200000);
  const auto walls = simulation.walls();
  CAPTURE(walls[0].place.y, walls[3].place.y, walls[0].force.y, walls[3].force.y);
  CHECK(walls[0].place.y > 0);
  CHECK(std::abs(walls[0].place.y + (walls[3].place.y - 4.05)) < 1e-15 * 4);
  CHECK(std::abs(0.5 * (walls[3].force.y - walls[0].force.y) - 10) < 1e-6 * 10);
}

TEST_CASE("a_stress_acts_on_the_present_length_between_neighbours") {
  GrainScene scene = pressed_columns(NormalLaw::linear_dashpot, 20);
  Servo& servo = *scene.walls[3].servo;
  servo.is_stress = true;
  servo.between = {"left", "right"};
  scene.walls[2].move_x = {Schedule::Kind::ramp, 2.0, 10, 20};
  GrainSimulation simulation(scene, options_of(servo_steppings[1], 2e-4));
  simulation.advance(10000);
  CHECK(simulation.servos().front().wanted == 80);
  simulation.advance(100000);
  CHECK(std::abs(simulation.servos().front().wanted - 120) < 1e-12 * 120);
}

TEST_CASE("a_force_that_grows_by_a_schedule_is_followed") {
  GrainScene scene = pressed_columns(NormalLaw::exact_flow, 20);
  scene.walls[3].servo->wanted = {Schedule::Kind::table, 0, 0, 0, 0, {0, 10, 30}, {5, 5, 30}};
  GrainSimulation simulation(scene, options_of(NormalLaw::exact_flow, 1e-3));
  simulation.advance(20000);
  const ServoReport half_way = simulation.servos().front();
  CHECK(std::abs(half_way.present - 17.5) < 0.05);
  simulation.advance(20000);
  CHECK(std::abs(simulation.servos().front().present - 30) < 1e-4 * 30);
}

TEST_CASE("a_servo_wall_keeps_below_its_speed") {
  const GrainScene scene = pressed_columns(NormalLaw::linear_dashpot, 20);
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 2e-4));
  double fastest = 0, place = 4.05;
  for (int k = 0; k < 10000; ++k) {
    simulation.advance(1);
    const double now = simulation.walls()[3].place.y;
    fastest = std::max(fastest, std::abs(now - place) / 2e-4);
    place = now;
  }
  CHECK(fastest <= 0.1 * (1 + 1e-9));
  CHECK(fastest > 0.09);
}

TEST_CASE("a_servo_wall_runs_past_its_force_by_less_than_the_push_of_a_disc_at_its_speed_however_slowly_it_mends") {
  // A disc that meets a wall at the speed v pushes it by v sqrt(k m) at most: the control adds nothing to that.
  const double relaxation = GENERATE(0.5, 0.1, 0.02, 0.005);
  const int discs = GENERATE(1, 2, 8);
  std::vector<Grain> column;
  for (int k = 0; k < discs; ++k) column.push_back(ball({0.5, k + 0.5}, 0.5));
  GrainScene scene = scene_of(column, {line("floor", {0, 0}, {0, 1}), line("lid", {0, discs + 0.005}, {0, -1})},
                              one_second(NormalLaw::linear_dashpot, 0.3));
  scene.pairs[0].stiffness *= 100;
  const double force = 20, speed = 0.1;
  const double push = speed * std::sqrt(scene.pairs[0].stiffness * column[0].inertia.mass);
  scene.walls[1] = pushing(scene.walls[1], force, speed);
  scene.walls[1].servo->relaxation = relaxation;
  GrainSimulation simulation(scene, options_of(servo_steppings[1], 1.5e-3));
  simulation.advance(100000);
  const ServoReport report = simulation.servos().front();
  CAPTURE(relaxation, discs, report.overshoot, report.peak, push / force, report.mean_error, report.present);
  CHECK(report.reached);
  CHECK(std::abs(report.present - force) < 1e-3 * force);
  CHECK(report.peak < push / force);
  CHECK(report.overshoot <= report.peak);
}

TEST_CASE("a_wall_that_chooses_its_speed_is_pushed_by_the_heaviest_disc_by_a_twentieth_of_its_force") {
  const Stepping stepping = GENERATE(from_range(servo_steppings));
  const double force = GENERATE(20.0, 5.0);
  GrainScene scene = scene_of({ball({0.5, 0.55}, 0.5, {}, 2), ball({3, 0.55}, 0.5)},
                              {pushing(line("lid", {0, 1.3}, {0, -1}), force)}, one_second(stepping.law, 1));
  scene.walls[0].servo->max_speed.reset();
  GrainSimulation coming(scene, options_of(stepping, 2e-4));
  coming.advance(1);
  const double speed = coming.servos().front().max_speed;
  CHECK(-coming.walls().front().velocity.y == speed);
  // the same seen from the wall
  scene.walls[0].servo.reset();
  scene.grains[0].velocity = {0, speed};
  GrainSimulation still(scene, options_of(stepping, 2e-4));
  double push = 0;
  for (int k = 0; k < 200000 && (push == 0 || !still.contacts().empty()); ++k) {
    still.advance(1);
    push = std::max(push, still.walls().front().force.y);
  }
  CAPTURE(stepping.name(), force, speed, push);
  CHECK(push == Approx(0.05 * force).epsilon(1e-3));
}

TEST_CASE("a_servo_wall_follows_bodies_that_give_way_without_a_lasting_error") {
  const double relaxation = GENERATE(0.5, 0.1, 0.02);
  GrainScene scene = scene_of({ball({0.5, 0.5}, 0.5), ball({0.5, 1.5}, 0.5)},
                              {line("floor", {0, 0}, {0, 1}), line("lid", {0, 2.005}, {0, -1})},
                              one_second(NormalLaw::linear_dashpot, 0.3));
  scene.pairs[0].stiffness *= 100;
  const double force = 20, step = 1.5e-3, away = 0.02;
  scene.walls[0].move_y = {Schedule::Kind::table, 0, 0, 0, 0, {0, 20, 220}, {0, 0, -200 * away}};
  scene.walls[1] = pushing(scene.walls[1], force, 0.1);
  scene.walls[1].servo->relaxation = relaxation;
  GrainSimulation simulation(scene, options_of(servo_steppings[1], step));
  simulation.advance(100000);
  // by the force alone a wall would lag behind by k dt v/relaxation
  const double lag = scene.pairs[0].stiffness * step * away / relaxation;
  CAPTURE(relaxation, lag, simulation.servos().front().present);
  CHECK(std::abs(simulation.servos().front().present - force) < 0.01 * lag);
}

TEST_CASE("a_servo_wall_that_meets_no_body_is_an_error_and_no_endless_way") {
  GrainScene scene = pressed_columns(NormalLaw::linear_dashpot, 20);
  scene.walls[3].normal = {0, -1};
  scene.walls[3].servo->direction = {0, 1};
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 2e-3));
  check_refused([&] { simulation.advance(1000000); }, {"'lid'", "met no body"}, ErrorKind::computation_failed);
  CHECK_FALSE(simulation.servos().front().touched);
}

TEST_CASE("servos_that_contradict_each_other_are_refused") {
  const GrainScene sound = pressed_columns(NormalLaw::linear_dashpot, 20);
  const auto refused = [&](const auto& change, std::vector<std::string> words,
                           NormalLaw law = NormalLaw::linear_dashpot) {
    GrainScene scene = sound;
    change(scene, *scene.walls[3].servo);
    check_refused([&] { check(scene, options_of(law, 2e-4)); }, words);
  };
  check(sound, options_of(NormalLaw::linear_dashpot, 2e-4));
  refused([](GrainScene&, Servo& s) { s.wanted.value = -1; }, {"'lid'", "-1", "pull"});
  refused([](GrainScene&, Servo& s) { s.wanted = {Schedule::Kind::sine, 5, 0, 0, 1}; }, {"'lid'", "pull"});
  refused([](GrainScene&, Servo& s) { s.max_speed = 0; }, {"'lid'", "max_speed"});
  refused([](GrainScene&, Servo& s) { s.relaxation = 1.5; }, {"'lid'", "relaxation"});
  refused([](GrainScene&, Servo& s) { s.direction = {0, 2}; }, {"'lid'", "unit vector"});
  refused([](GrainScene&, Servo& s) { s.mirror = "top"; }, {"'lid'", "'top'", "no wall"});
  refused([](GrainScene&, Servo& s) { s.mirror = "lid"; }, {"'lid'", "own mirror"});
  refused([](GrainScene& g, Servo& s) { s.mirror = "floor", g.walls[1].servo = s; }, {"'floor'", "does so too"});
  refused(
      [](GrainScene& g, Servo&) {
        g.walls[3].move_y = {Schedule::Kind::ramp, 1, 0, 1};
      },
      {"'lid'", "displacement"});
  refused([](GrainScene&, Servo& s) { s.is_stress = true; }, {"'lid'", "no other wall"});
  refused([](GrainScene&, Servo& s) { s.is_stress = true, s.between = {"left", "floor"}; }, {"'floor'", "cross"});
  refused([](GrainScene&, Servo&) {}, {"'lid'", "map"}, NormalLaw::energy_map);
}

TEST_CASE("a_servo_wall_on_bodies_at_rest_begins_with_the_force_that_they_carry") {
  const Stepping stepping = GENERATE(from_range(servo_steppings));
  GrainScene scene = pressed_columns(stepping.law, 20);
  GrainSimulation settled(scene, options_of(stepping, 2e-4));
  settled.advance(200000);
  scene.grains = settled.grains();
  scene.walls[3].point = settled.walls()[3].place;
  GrainSimulation again(scene, options_of(stepping, 2e-4));
  again.advance(1);
  const WallState lid = again.walls()[3];
  CAPTURE(stepping.name(), lid.velocity.y, lid.force.y, lid.impulse.y);
  CHECK(std::abs(lid.velocity.y) < 1e-3 * 0.1);
  CHECK(std::abs(lid.force.y - 20) < 1e-3 * 20);
  CHECK(std::abs(lid.impulse.y - 20 * 2e-4) < 1e-3 * 20 * 2e-4);  // of one step
}

TEST_CASE("the_error_of_a_servo_wall_counts_from_where_the_force_of_its_stage_is_reached") {
  GrainStage low{.name = "low", .scene = pressed_columns(NormalLaw::linear_dashpot, 10), .steps = 200000}, high = low,
                                                                                                           back = low;
  high.name = "high";
  high.scene.walls[3].servo->wanted.value = 40;
  back.name = "back";
  StagedSimulation staged({low, high, back}, options_of(NormalLaw::linear_dashpot, 2e-4));
  while (!staged.over()) staged.advance(100000);
  const std::vector<double> wanted{10, 40, 10};
  REQUIRE(staged.reports().size() == 3);
  StagedSimulation resumed({low, high, back}, options_of(NormalLaw::linear_dashpot, 2e-4));
  resumed.restore(staged.save());
  for (std::size_t k = 0; k < 3; ++k) {
    REQUIRE(staged.reports()[k].servos.size() == 1);
    const ServoReport report = staged.reports()[k].servos[0];
    CAPTURE(k, report.wanted, report.present, report.overshoot, report.mean_error);
    CHECK(report.reached);
    CHECK(report.wanted == wanted[k]);
    CHECK(std::abs(report.present - wanted[k]) < 1e-3 * wanted[k]);
    CHECK(report.mean_error < 0.01);
    if (k > 0) CHECK(report.overshoot < 0.3);  // the way from the force before would be 3 where it falls
    REQUIRE(resumed.reports()[k].servos.size() == 1);
    CHECK(resumed.reports()[k].servos[0].mean_error == report.mean_error);
    CHECK(resumed.reports()[k].servos[0].wall == "lid");
  }
}
