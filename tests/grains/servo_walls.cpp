// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Walls that follow a force or a stress.
#include "equidem/grains/stages/staged_simulation.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

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
