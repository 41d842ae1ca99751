// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Runs in stages.
#include "equidem/grains/contacts/bonds.hpp"

#include "grains/bonded_scenes.hpp"
#include "grains/cell_scenes.hpp"
#include "grains/resuming.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Three stages of a busy box: as it is, with less friction, stiffer contacts and a servo, and without its lid, with
/// another gravity.
std::vector<GrainStage> busy_stages(NormalLaw law, std::int64_t length) {
  GrainScene scene = busy_box(law, 4, 3, 3);
  for (Wall& wall : scene.walls) wall.move_x = wall.move_y = {};
  std::vector<GrainStage> stages{{.name = "as it is", .scene = scene, .steps = length}};
  scene.pairs[0].friction = 0.1;
  scene.pairs[0].stiffness *= 2;
  scene.walls[0].move_x = {Schedule::Kind::sine, 0.1, 0, 0, 0.5};
  if (!is_map(law)) scene.walls[1].servo = Servo{.direction = {1, 0}, .wanted = {.value = 3}, .max_speed = 0.5};
  stages.push_back({.name = "pressed", .scene = scene, .steps = length});
  scene.walls.pop_back();
  std::rotate(scene.walls.begin(), scene.walls.begin() + 1, scene.walls.end());
  scene.gravity = {0.5, -2};
  stages.push_back({.name = "open", .scene = scene, .steps = length});
  return stages;
}

/// A run in stages of `length` steps that are all the same, and one without stages.
void check_stages_that_change_nothing(const GrainScene& scene, const GrainOptions& options, std::int64_t length,
                                      std::int64_t last) {
  std::vector<GrainStage> same;
  for (std::int64_t k = 0; k * length < last; ++k)
    same.push_back({.name = std::to_string(k), .scene = scene, .steps = length});
  StagedSimulation staged(same, options);
  GrainSimulation whole(scene, options);
  std::size_t listed = 0, met = 0, early = 0;
  for (std::int64_t step = 0; step < last; step += length) {
    run_to(staged, std::min(step + length, last));
    whole.advance(std::min(length, last - step));
    if (step == 0) early = whole.breaks().size();
    listed += staged.present().contacts().size();
    met += whole.contacts().size();
  }
  CAPTURE(staged.energy().work_of_stages, early, whole.breaks().size());
  REQUIRE(staged.step() == last);
  CHECK(listed == met);
  CHECK((met > 0 || !scene.bonds.empty()));
  const std::vector<Grain> grains = staged.present().grains(), expected = whole.grains();
  for (std::size_t g = 0; g < scene.grains.size(); ++g) {
    CHECK(grains[g].position == expected[g].position);
    CHECK(grains[g].velocity == expected[g].velocity);
    CHECK(grains[g].angle == expected[g].angle);
    CHECK(grains[g].spin == expected[g].spin);
  }
  CHECK(staged.energy().work_of_stages == 0);  // what is round-off of the energies is not counted
  CHECK(std::abs(staged.energy().error() - whole.energy().error()) <= 1e-12 * whole.energy().largest());
  REQUIRE(staged.present().breaks().size() == whole.breaks().size());
  for (std::size_t b = 0; b < whole.breaks().size(); ++b) {
    CHECK(staged.present().breaks()[b].bond == whole.breaks()[b].bond);
    CHECK(staged.present().breaks()[b].step == whole.breaks()[b].step);
  }
  if (scene.strengths) CHECK((early > 0 && whole.breaks().size() > early));
  if (!scene.cell) return;
  CHECK(staged.cell()->height == whole.cell()->height);
  CHECK(staged.cell()->shift == whole.cell()->shift);
  CHECK(staged.cell()->strain.xy == whole.cell()->strain.xy);
  CHECK(staged.energy().work_of_cell == whole.energy().work_of_cell);
}

/// A disc that falls on a floor with little restitution.
GrainStage falling_disc(std::int64_t limit, StageEnd end) {
  PairProperties pair = one_second(NormalLaw::linear_dashpot, 0.2);
  pair.stiffness *= 100;
  return {.name = "settle",
          .scene = scene_of({ball({0, 0.6}, 0.5)}, {line("floor", {0, 0}, {0, 1})}, pair, {0, -1}),
          .steps = limit,
          .end = end};
}

}  // namespace

TEST_CASE("the_effects_of_a_run_are_those_of_all_its_stages_together") {
  GrainStage calm = falling_disc(10, {}), busy = calm;
  busy.name = "busy";
  busy.scene.pairs[0].friction = 0.3;
  busy.scene.pairs[0].tangential_ratio = 0.5;
  busy.scene.walls.push_back(line("lid", {0, 2}, {0, -1}));
  busy.scene.walls[0].move_x = {Schedule::Kind::sine, 0.1, 0, 0, 0.5};
  busy.scene.walls[1].servo = Servo{.direction = {0, -1}, .wanted = {.value = 3}, .max_speed = 0.5};
  const StagedSimulation staged({calm, busy, calm}, options_of(NormalLaw::linear_dashpot, 1e-3));
  const std::vector<std::string> active = active_effects(staged.effects()), first = staged.reports()[0].effects;
  CAPTURE(active, first);
  for (const char* name : {"friction", "tangential springs", "rotation", "motion of walls", "servo walls"}) {
    CHECK(std::ranges::find(active, name) != active.end());
    CHECK(std::ranges::find(first, name) == first.end());
  }
  CHECK(std::ranges::find(active, "bonds") == active.end());
  CHECK(staged.effects().tangential_springs);
}

TEST_CASE("a_stage_that_changes_nothing_leaves_the_motion_as_it_is_to_the_last_bit") {
  const Stepping stepping = GENERATE(from_range(stage_steppings));
  CAPTURE(stepping.name());
  GrainScene scene = busy_box(stepping.law, 4, 3, 3);
  for (Wall& wall : scene.walls) wall.move_x = wall.move_y = {};
  check_stages_that_change_nothing(scene, options_of(stepping, 4e-3), 237, 600);
  if (!gives_force(stepping.law)) return;
  GrainBond like = all_of_a_bond;
  like.bending_spring = 0.4;
  GrainScene chain = chain_scene(stepping.law, 12, like);
  chain.strengths = bond_strengths(chain, {.tension = 0.9, .shear = 0.7, .friction = 0.2, .weibull_modulus = 3.0});
  check_stages_that_change_nothing(chain, options_of(stepping, 1e-3), 400, 3000);
  if (stepping.integrator != GrainIntegrator::velocity_verlet) return;
  GrainScene cell = busy_cell(stepping.law, 6, 5, 31);
  check_stages_that_change_nothing(cell, options_of(stepping, 2e-3), 437, 1100);
  cell.cell->rate_xy = {.value = 2};
  cell.cell->servo = CellServo{.stress_yy = Schedule{.value = -5}, .max_rate = 0.2};
  check_stages_that_change_nothing(cell, options_of(stepping, 2e-3), 437, 1100);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    GrainScene shapes = mixed_box(stepping.law, 5, 4, seed);
    for (Wall& wall : shapes.walls) wall.move_x = wall.move_y = {};
    for (PairProperties& pair : shapes.pairs) pair.stiffness *= 100;
    shapes.gravity = {0, -10};
    check_stages_that_change_nothing(shapes, options_of(stepping, 1e-3), 100, 4000);
  }
}

TEST_CASE("the_ledger_closes_over_stages_that_change_walls_friction_and_gravity") {
  // maps make energy where several contacts act on a body
  const Stepping stepping =
      GENERATE(filter([](const Stepping& s) { return !is_map(s.law); }, from_range(stage_steppings)));
  CAPTURE(stepping.name());
  std::vector<double> errors;
  for (const int finer : {1, 8}) {
    StagedSimulation staged(busy_stages(stepping.law, 400 * finer), options_of(stepping, 1e-3 / finer));
    double changed = 0;
    while (!staged.over()) {
      staged.advance(400 * finer);
      if (staged.over()) break;
      const EnergyLedger before = staged.energy();
      staged.advance(0);  // the next stage begins
      const EnergyLedger after = staged.energy();
      CAPTURE(finer, staged.step(), before.error(), after.error());
      CHECK(std::abs(after.error() - before.error()) <= 1e-12 * before.largest());
      changed += std::abs(after.work_of_stages - before.work_of_stages);
    }
    const EnergyLedger ledger = staged.energy();
    errors.push_back(std::abs(ledger.error()) / ledger.largest());
    CAPTURE(finer, errors, changed, ledger.largest());
    if (finer > 1) CHECK(changed > 5 * std::abs(ledger.error()));  // without that term the balance would not close
    CHECK(staged.reports().size() == 3);
    CHECK(staged.walls().size() == 3);
    CHECK(staged.reports()[1].first == 400 * finer);
  }
  CAPTURE(errors);
  CHECK(errors[0] <= 2e-3);
  CHECK(errors[1] <= 0.4 * errors[0] + 1e-12);
}

TEST_CASE("a_run_in_stages_goes_on_from_any_saved_state_with_the_same_bits") {
  const Stepping stepping = GENERATE(from_range(stage_steppings));
  CAPTURE(stepping.name());
  CHECK(check_resuming(busy_stages(stepping.law, 60), options_of(stepping, 4e-3), 7).reports().size() == 3);
}

TEST_CASE("a_stage_ends_when_its_bodies_are_at_rest") {
  StagedSimulation staged({falling_disc(100000, {.kinetic = 1e-6, .unbalanced = 1e-4})},
                          options_of(NormalLaw::linear_dashpot, 1e-3));
  run_to(staged, 100000);
  const StageReport& report = staged.reports().front();
  CHECK(staged.over());
  CHECK(report.ended);
  CHECK(staged.step() < 100000);
  CHECK(report.kinetic <= 1e-6);
  CHECK(report.unbalanced <= 1e-4);
  CHECK(std::abs(staged.walls().front().force.y + 1) <= 1e-3);
}

TEST_CASE("a_stage_that_does_not_come_to_rest_stops_at_its_limit_and_goes_on_with_a_longer_one") {
  const GrainOptions options = options_of(NormalLaw::linear_dashpot, 1e-3);
  const StageEnd rest{.kinetic = 1e-6, .unbalanced = 1e-4};
  StagedSimulation brief({falling_disc(500, rest)}, options);
  for (int k = 0; k < 2; ++k) {
    const Refusal refusal = check_refused([&] { brief.advance(100000); }, {"0.5 s"}, ErrorKind::computation_failed);
    CHECK(refusal.where == "stage 'settle'");
    CHECK(brief.step() == 500);
  }
  StagedSimulation longer({falling_disc(100000, rest)}, options), direct({falling_disc(100000, rest)}, options);
  longer.restore(brief.save());
  run_to(longer, 100000);
  run_to(direct, 100000);
  CHECK(longer.over());
  CHECK(longer.step() == direct.step());
  CHECK(bits_of(longer.present()) == bits_of(direct.present()));
}

TEST_CASE("a_stage_ends_by_the_way_of_a_wall_and_by_the_strain_between_two") {
  GrainStage stage = falling_disc(10000, {.displacement = 0.1, .wall = "lid"});
  stage.scene.walls.push_back(line("lid", {0, 3}, {0, -1}));
  stage.scene.walls[1].move_y = {Schedule::Kind::table, 0, 0, 0, 0, {0, 100}, {0, -10}};  // 0.1 m/s
  GrainStage back = stage;
  back.name = "back";
  back.end = {.strain = 0.05, .walls = {"floor", "lid"}};
  back.scene.walls[1].move_y = {Schedule::Kind::table, 0, 0, 0, 0, {0, 100}, {0, 10}};
  StagedSimulation staged({stage, back}, options_of(NormalLaw::linear_dashpot, 1e-3));
  staged.advance(10000);
  CHECK(staged.milestone() == staged.step());  // a call stops at the end of a stage
  CHECK_FALSE(staged.over());
  run_to(staged, 10000);
  const auto& reports = staged.reports();
  REQUIRE(reports.size() == 2);
  CHECK(std::abs(reports[0].displacement - 0.1) <= 16 * 1e-4);
  CHECK(reports[0].displacement >= 0.1 * (1 - 1e-12));
  CHECK(std::abs(reports[1].strain - 0.05) <= 16 * 1e-4 / 2.9);
  CHECK(std::abs(staged.walls()[1].place.y - (3 - 0.1) * 1.05) <= 0.01);
}

TEST_CASE("a_wall_that_is_taken_away_pushes_no_more") {
  const Stepping stepping = GENERATE(from_range(stage_steppings));
  CAPTURE(stepping.name());
  PairProperties pair = one_second(stepping.law, 1);
  pair.stiffness *= 100;
  GrainStage pressed{.name = "pressed",
                     .scene = scene_of({ball({0, 0.51}, 0.5, {0, -1})}, {line("floor", {0, 0}, {0, 1})}, pair),
                     .steps = 40};
  GrainStage free = pressed;
  free.name = "free";
  free.scene.walls.clear();
  StagedSimulation staged({pressed, free}, options_of(stepping, 1e-3));
  staged.advance(40);
  REQUIRE(staged.milestone() == 40);
  const Vec2 impulse = staged.walls().front().impulse;
  const EnergyLedger before = staged.energy();
  staged.advance(30);
  const EnergyLedger after = staged.energy();
  CAPTURE(impulse.y, staged.velocities()[0].u.y, before.elastic(), after.work_of_stages);
  CHECK(norm(impulse) > 0.01);
  CHECK(std::abs(staged.velocities()[0].u.y - (-1 - impulse.y)) <= 1e-12);
  CHECK(std::abs(after.work_of_stages + before.elastic()) <= 1e-12);
  CHECK(std::abs(after.error() - before.error()) <= 1e-12);
}

TEST_CASE("stages_that_name_no_wall_are_refused") {
  const GrainOptions options = options_of(NormalLaw::linear_dashpot, 1e-3);
  const auto refused = [&](const GrainStage& stage, const std::string& word) {
    check_refused([&] { StagedSimulation({stage}, options); }, {word});
  };
  refused(falling_disc(10, {.displacement = 1, .wall = "lid"}), "'lid'");
  refused(falling_disc(10, {.strain = 1, .walls = {"floor", "top"}}), "'top'");
  GrainStage twice = falling_disc(10, {});
  twice.scene.walls.push_back(line("floor", {0, 5}, {0, -1}));
  refused(twice, "two walls 'floor'");
}

TEST_CASE("a_stage_goes_on_from_a_state_in_which_a_wall_has_receded_and_its_bodies_with_it") {
  GrainStage settle = falling_disc(400, {});
  GrainStage sink = settle;
  sink.name = "sink";
  sink.steps = 4000;
  sink.scene.walls[0].move_y = {Schedule::Kind::table, 0, 0, 0, 0, {0, 100}, {0, -50}};  // 0.5 m/s
  sink.scene.walls.push_back(line("lid", {0, 3}, {0, -1}));
  sink.scene.walls[1].servo = Servo{.direction = {0, -1}, .wanted = {.value = 1}, .max_speed = 2};
  const GrainOptions options = options_of(NormalLaw::linear_dashpot, 1e-3);
  StagedSimulation whole({settle, sink}, options), half({settle, sink}, options), resumed({settle, sink}, options);
  run_to(whole, 4400);
  run_to(half, 3400);
  CAPTURE(half.motions()[0].u.y);
  REQUIRE(half.motions()[0].u.y < -0.5);  // below the place where the floor stood
  resumed.restore(half.save());
  run_to(resumed, 4400);
  CHECK(bits_of(resumed.present()) == bits_of(whole.present()));
}

TEST_CASE("a_stage_that_cannot_begin_leaves_the_one_before_as_it_is") {
  GrainStage settle = falling_disc(400, {}), shut = settle;
  shut.name = "shut";
  shut.scene.walls.push_back(line("lid", {0, 0.2}, {0, -1}));  // below the centre of the disc
  StagedSimulation staged({settle, shut}, options_of(NormalLaw::linear_dashpot, 1e-3));
  run_to(staged, 400);
  const SavedState before = staged.save();
  for (int k = 0; k < 2; ++k) {
    CHECK(refusal_of([&] { staged.advance(1); }).where == "stage 'shut'");
    CHECK(staged.save() == before);
    CHECK(staged.walls().size() == 1);
  }
}

TEST_CASE("a_standing_wall_that_would_jump_is_refused") {
  GrainStage settle = falling_disc(400, {}), press = settle;
  press.name = "press";
  press.scene.walls[0].move_y = {Schedule::Kind::table, 0, 0, 0, 0, {0, 1}, {0.1, 0.2}};
  check_refused(
      [&] {
        StagedSimulation({settle, press}, options_of(NormalLaw::linear_dashpot, 1e-3));
      },
      {"'floor'", "jump"});
}
