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
  GrainScene scene = still(busy_box(law, 4, 3, 3));
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

BodyChoice in_box(Vec2 low, Vec2 high) {
  return {.kinds = {}, .box = Rectangle{low, high}};
}

PairProperties firm(NormalLaw law) {
  PairProperties pair = one_second(law, 0.7);
  pair.stiffness *= 100;
  pair.friction = 0.3;
  pair.tangential_ratio = 0.5;
  return pair;
}

/// A busy box that loses two bodies, renames some, and gets two others.
std::vector<GrainStage> changing_stages(GrainScene scene, std::int64_t length) {
  for (Wall& wall : scene.walls) wall.move_x = wall.move_y = {};
  scene.kinds = 2;
  PairProperties other = scene.pairs[0];
  other.friction = 0.1;
  other.stiffness *= 2;
  scene.pairs = {scene.pairs[0], other, other, other};
  GrainStage first{.name = "as it is", .scene = scene, .steps = length};
  GrainStage fewer = first, more = first;
  fewer.name = "fewer";
  fewer.bodies.removed = {in_box({0, 0}, {1, 2.4})};
  fewer.bodies.renamed = {{in_box({2, 0}, {9, 9}), std::vector<int>(scene.grains.size(), 1)}};
  more.name = "more";
  more.bodies.removed = {{.kinds = {1}, .box = Rectangle{{3, 0}, {4, 2}}}};
  more.bodies.added = {ball({0.3, 0.3}, 0.25, {0.5, 0}), ball({0.8, 1.2}, 0.3, {0, -1}, 2)};
  more.bodies.added[1].kind = 1;
  return {first, fewer, more};
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
  GrainStage calm = falling_disc(10, {}), busy = named(calm, "busy");
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
  GrainScene scene = still(busy_box(stepping.law, 4, 3, 3));
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
    GrainScene shapes = still(mixed_box(stepping.law, 5, 4, seed));
    for (PairProperties& pair : shapes.pairs) pair.stiffness *= 100;
    shapes.gravity = {0, -10};
    check_stages_that_change_nothing(shapes, options_of(stepping, 1e-3), 100, 4000);
  }
}

TEST_CASE("the_ledger_closes_over_stages_that_change_walls_friction_gravity_or_bodies") {
  // maps make energy where several contacts act on a body
  const Stepping stepping =
      GENERATE(filter([](const Stepping& s) { return !is_map(s.law); }, from_range(stage_steppings)));
  const bool of_bodies = GENERATE(false, true);
  std::vector<double> errors;
  for (const int finer : {1, 8}) {
    const std::int64_t length = (of_bodies ? 300 : 400) * finer;
    StagedSimulation staged(
        of_bodies ? changing_stages(busy_box(stepping.law, 4, 3, 3), length) : busy_stages(stepping.law, length),
        options_of(stepping, 1e-3 / finer));
    double changed = 0;
    while (!staged.over()) {
      staged.advance(length);
      if (staged.over()) break;
      const EnergyLedger before = staged.energy();
      staged.advance(0);  // the next stage begins
      const EnergyLedger after = staged.energy();
      CAPTURE(stepping.name(), of_bodies, finer, staged.step(), before.error(), after.error());
      CHECK(std::abs(after.error() - before.error()) <= 1e-12 * before.largest());
      if (of_bodies) CHECK(std::abs(after.work_of_stages - before.work_of_stages) > 0.01);
      changed += std::abs(after.work_of_stages - before.work_of_stages);
    }
    const EnergyLedger ledger = staged.energy();
    errors.push_back(std::abs(ledger.error()) / ledger.largest());
    CAPTURE(stepping.name(), finer, errors, changed, ledger.largest());
    // without the work of stages the balance would not close
    if (finer > 1 && !of_bodies) CHECK(changed > 5 * std::abs(ledger.error()));
    REQUIRE(staged.reports().size() == 3);
    CHECK(staged.reports()[1].first == length);
    CHECK(staged.walls().size() == (of_bodies ? 4 : 3));
    if (!of_bodies) continue;
    CHECK(staged.reports()[1].removed == 2);
    CHECK(staged.reports()[1].renamed > 2);
    CHECK(staged.reports()[2].removed > 0);
    CHECK(staged.reports()[2].added == 2);
    CHECK(staged.motions().size() == 14);
  }
  CAPTURE(stepping.name(), of_bodies, errors);
  CHECK(errors[0] <= 2e-3);
  CHECK(errors[1] <= 0.4 * errors[0] + 1e-12);
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
  GrainStage back = named(stage, "back");
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
  GrainStage free = named(pressed, "free");
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
  GrainStage sink = named(settle, "sink");
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
  GrainStage settle = falling_disc(400, {}), shut = named(settle, "shut");
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
  GrainStage settle = falling_disc(400, {}), press = named(settle, "press");
  press.scene.walls[0].move_y = {Schedule::Kind::table, 0, 0, 0, 0, {0, 1}, {0.1, 0.2}};
  check_refused(
      [&] {
        StagedSimulation({settle, press}, options_of(NormalLaw::linear_dashpot, 1e-3));
      },
      {"'floor'", "jump"});
}

TEST_CASE("a_body_that_is_taken_away_pushes_and_pulls_no_more") {
  const Stepping stepping = GENERATE(from_range(stage_steppings));
  const bool bonded = GENERATE(false, true);
  if (bonded && stepping.law == NormalLaw::exact_flow) return;
  GrainScene scene = scene_of({ball({0, 0}, 0.5, {1, 0.2}), ball({0.98, 0}, 0.5, {-1, 0}, 2)}, {}, firm(stepping.law));
  scene.grains[1].spin = 1;
  if (bonded)
    scene.bonds = {{.i = 0,
                    .j = 1,
                    .normal_dashpot = 3,
                    .tangential_dashpot = 2,
                    .normal_spring = 500,
                    .tangential_spring = 300,
                    .bending_spring = 20}};
  const std::size_t left = GENERATE(0, 1);
  GrainStage both{.name = "both", .scene = scene, .steps = 30};
  GrainStage alone = named(both, "alone");
  alone.bodies.removed = {left == 0 ? in_box({0.3, -1}, {2, 1}) : in_box({-1, -1}, {0.4, 1})};
  StagedSimulation staged({both, alone}, options_of(stepping, 2e-3));
  staged.advance(30);
  const Vec2 velocity = staged.velocities()[left].u;
  const double spin = staged.velocities()[left].theta;
  const EnergyLedger before = staged.energy();
  staged.advance(30);
  const EnergyLedger after = staged.energy();
  CAPTURE(stepping.name(), bonded, left, before.elastic(), after.work_of_stages);
  if (!is_map(stepping.law)) CHECK(before.elastic() > 0.01);
  CHECK(norm(staged.velocities()[left].u - velocity) < 1e-14);
  CHECK(std::abs(staged.velocities()[left].theta - spin) < 1e-13);
  CHECK_FALSE(is_there(staged.motions()[1 - left]));
  CHECK(staged.present().grains()[left].present);
  CHECK_FALSE(staged.present().grains()[1 - left].present);
  CHECK(staged.reports()[1].removed == 1);
  CHECK(std::abs(after.error() - before.error()) < 1e-13);
  CHECK(after.work_of_stages < -before.elastic());  // and its kinetic energy
}

TEST_CASE("bodies_that_nothing_met_leave_no_trace_when_they_go") {
  const Stepping stepping = GENERATE(from_range(stage_steppings));
  GrainScene scene = still(busy_box(stepping.law, 4, 3, 3));
  GrainStage more{.name = "more", .scene = scene, .steps = 150};
  more.scene.grains.insert(more.scene.grains.begin() + 5, ball({2, 20}, 0.4));
  more.scene.grains.push_back(ball({3, 30}, 0.4));
  more.scene.gravity = scene.gravity;
  more.scene.walls.pop_back();  // the lid
  GrainScene open = scene;
  open.walls.pop_back();
  GrainStage fewer = named(more, "fewer");
  fewer.steps = 400;
  fewer.bodies.removed = {in_box({0, 15}, {9, 99})};
  StagedSimulation staged({more, fewer}, options_of(stepping, 2e-3));
  GrainSimulation plain(open, options_of(stepping, 2e-3));
  run_to(staged, 500);
  plain.advance(500);
  double off = 0;
  const auto grains = staged.present().present_grains();
  REQUIRE(grains.size() == scene.grains.size());
  for (std::size_t g = 0; g < grains.size(); ++g)
    off = std::max(off, norm(grains[g].position - plain.grains()[g].position));
  CAPTURE(stepping.name(), off);
  CHECK(off < 1e-10);
  CHECK_FALSE(is_there(staged.motions()[5]));
  CHECK(staged.motions()[6].u == grains[5].position);
  CHECK(plain.counters().contacts > 10);
}

TEST_CASE("a_run_in_stages_goes_on_from_any_saved_state_with_the_same_bits") {
  enum Changing { walls, discs, bonded_discs, shapes };
  const Stepping stepping = GENERATE(from_range(stage_steppings));
  const Changing changing = GENERATE(walls, discs, bonded_discs, shapes);
  if (changing > discs && !gives_force(stepping.law)) return;
  GrainScene scene = changing == shapes ? mixed_box(stepping.law, 4, 3, 5) : busy_box(stepping.law, 4, 3, 5);
  if (changing == bonded_discs) {
    for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 4}, {5, 8}, {6, 7}, {9, 10}, {10, 11}})
      scene.bonds.push_back(
          {.i = i, .j = j, .normal_dashpot = 1, .normal_spring = 300, .tangential_spring = 100, .bending_spring = 5});
    scene.strengths = ContactStrengths{{14, 9, 99, 9, 14, 14}, {9, 5, 99, 5, 9, 9}, 0.2};
  }
  CAPTURE(stepping.name(), static_cast<int>(changing));
  const StagedSimulation whole = check_resuming(
      changing == walls ? busy_stages(stepping.law, 60) : changing_stages(scene, 60), options_of(stepping, 4e-3), 7);
  CHECK(whole.reports().size() == 3);
  if (changing != bonded_discs) return;
  CHECK(whole.breaks().size() > 0);
  CHECK(whole.holding_bonds().bonds.size() + whole.breaks().size() < whole.bonds().size());  // some went
}

TEST_CASE("discs_move_on_as_they_did_where_the_first_shape_comes_in_a_stage_and_the_last_one_goes") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const bool in_cell = GENERATE(false, true), bonded = GENERATE(false, true);
  if (in_cell && stepping.integrator == GrainIntegrator::semi_implicit_euler) return;
  GrainScene scene = busy_box(stepping.law, 4, 3, 5);
  scene.walls.pop_back();
  if (bonded)
    for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 4}, {5, 8}})
      scene.bonds.push_back({.i = i, .j = j, .normal_dashpot = 1, .normal_spring = 300, .tangential_spring = 100});
  if (in_cell) {
    scene.walls.resize(1);
    scene.walls[0].move_x = {};
    scene.cell = PeriodicCell{.along = PeriodicCell::Along::x, .corner = {0, 0}, .width = 4};
  }
  for (Wall& wall : scene.walls) wall.move_x = wall.move_y = {};
  GrainStage discs{.name = "discs", .scene = scene, .steps = 60}, shapes = discs, again = discs;
  shapes.name = "shapes";
  shapes.bodies.added = {oval({2, 40}, 0.4, 0.2, 1, {0.1, 0}),
                         lump(shapes.scene, {{{0, 0}, 0.3}, {{0.3, 0}, 0.2}}, {2, 50})};
  again.name = "again";
  again.scene.clumps = shapes.scene.clumps;
  again.bodies.removed = {in_box({-10, 30}, {10, 60})};
  const GrainOptions options = options_of(stepping, 4e-3);
  GrainSimulation whole(scene, options);
  StagedSimulation staged({discs, shapes, again}, options);
  double off = 0;
  std::size_t most = 0;
  for (int step = 0; step <= 180; ++step) {
    if (step > 0) whole.advance(1), staged.advance(1);
    for (std::size_t g = 0; g < scene.grains.size(); ++g) {
      off = std::max(off, norm(staged.present().grains()[g].position - whole.grains()[g].position));
      off = std::max(off, std::abs(staged.present().grains()[g].spin - whole.grains()[g].spin));
    }
    most = std::max(most, whole.contacts().size());
  }
  CAPTURE(stepping.name(), in_cell, bonded, off, most);
  CHECK(staged.reports()[1].added == 2);
  CHECK(staged.reports()[2].removed == 2);
  CHECK(most > 5);
  CHECK(off < 1e-9);
  check_resuming({discs, shapes, again}, options, 7);
}

TEST_CASE("breaks_keep_the_numbers_of_their_bonds_when_bodies_go") {
  GrainBond like = all_of_a_bond;
  like.bending_spring = 0.4;
  GrainScene scene = chain_scene(NormalLaw::linear_dashpot, 12, like);
  scene.strengths = bond_strengths(scene, {.tension = 0.9, .shear = 0.7, .friction = 0.2, .weibull_modulus = 3.0});
  const GrainOptions options = options_of(NormalLaw::linear_dashpot, 1e-3);
  GrainStage whole{.name = "whole", .scene = scene, .steps = 3000};
  GrainStage rest = named(whole, "rest");
  rest.steps = 10;
  StagedSimulation first({whole}, options);
  run_to(first, 3000);
  const std::vector<BondBreak> breaks = first.breaks();
  REQUIRE(breaks.size() > 2);
  // a disc of the first break goes, and one of a bond that holds
  const std::size_t gone = scene.bonds[breaks.front().bond].i;
  const Vec2 place = first.motions()[gone].u;
  rest.bodies.removed = {in_box(place - Vec2{0.01, 0.01}, place + Vec2{0.01, 0.01})};
  StagedSimulation staged({whole, rest}, options);
  run_to(staged, 3005);
  REQUIRE(staged.breaks().size() == breaks.size());
  for (std::size_t b = 0; b < breaks.size(); ++b) {
    CAPTURE(b, breaks[b].bond);
    CHECK(staged.breaks()[b].bond == breaks[b].bond);
    CHECK(staged.breaks()[b].step == breaks[b].step);
  }
  for (const GrainBond& bond : staged.bonds()) CHECK(bond.j == bond.i + 1);  // numbers of the run
  for (const GrainBond& bond : staged.holding_bonds().bonds) {
    CHECK(bond.i + 1 == bond.j);
    CHECK(bond.i != gone);
    CHECK(bond.j != gone);
  }
}

TEST_CASE("bodies_keep_their_numbers_in_contacts_and_errors_where_others_go") {
  const Stepping stepping = GENERATE(from_range(stage_steppings));
  GrainScene scene =
      scene_of({ball({0, 0}, 0.5), ball({5, 0}, 0.5), ball({9.02, 0}, 0.5, {0.1, 0}), ball({10, 0}, 0.5)}, {},
               firm(stepping.law));
  GrainStage all{.name = "all", .scene = scene, .steps = 4}, fewer = all, more = all;
  fewer.name = "fewer";
  fewer.bodies.removed = {in_box({-1, -1}, {1, 1})};
  more.name = "more";
  more.bodies.added = {ball({9.9, 0.1}, 0.5)};
  StagedSimulation staged({all, fewer, more}, options_of(stepping, 2e-3));
  run_to(staged, 6);
  const std::vector<GrainContact> contacts = staged.present().contacts();
  REQUIRE(contacts.size() == 1);
  CHECK(contacts[0].i == 2);
  CHECK(contacts[0].j == 3);
  CHECK(staged.body_contacts()[0].i == 2);
  CHECK(staged.present().grains()[3].position == staged.motions()[3].u);
  check_refused([&] { run_to(staged, 60); }, {"grains 3 and 4 start inside one another"});
}

TEST_CASE("a_body_that_is_added_inside_a_contact_moves_as_one_that_was_there_from_the_start") {
  const Stepping stepping = GENERATE(from_range(stage_steppings));
  const Grain resting = ball({0, 0}, 0.5), coming = ball({0.95, 0.1}, 0.5, {-0.3, 0.1}, 2);
  GrainScene scene = scene_of({resting}, {line("side", {-9, 0}, {1, 0})}, firm(stepping.law));
  GrainStage wait{.name = "wait", .scene = scene, .steps = 20};
  GrainStage meet = named(wait, "meet");
  meet.steps = 200;
  meet.bodies.added = {coming};
  StagedSimulation staged({wait, meet}, options_of(stepping, 2e-3));
  GrainScene both = scene;
  both.grains.push_back(coming);
  GrainSimulation plain(both, options_of(stepping, 2e-3));
  run_to(staged, 20);
  CHECK_FALSE(is_there(staged.motions()[1]));
  for (int k = 0; k < 200; ++k) {
    staged.advance(1);
    plain.advance(1);
    CAPTURE(stepping.name(), k);
    for (std::size_t g = 0; g < 2; ++g) {
      REQUIRE(norm(staged.motions()[g].u - plain.motions()[g].u) < 1e-12);
      REQUIRE(norm(staged.velocities()[g].u - plain.velocities()[g].u) < 1e-12);
    }
  }
  CHECK(plain.counters().contacts == 1);
  CHECK(staged.present().counters().contacts == 1);
  CHECK(std::abs(staged.energy().error() - plain.energy().error()) < 1e-12);
  CHECK(std::abs(staged.energy().work_of_stages - plain.energy().initial) < 1e-12);
}

TEST_CASE("a_disc_of_another_group_rests_on_its_floor_by_the_stiffness_of_that_group") {
  PairProperties soft = one_second(NormalLaw::linear_dashpot, 0.2);
  soft.stiffness = 1000;
  PairProperties hard = soft;
  hard.stiffness = 4000;
  GrainScene scene =
      scene_of({ball({0, 0.5}, 0.5), ball({3, 0.5}, 0.5)}, {line("floor", {0, 0}, {0, 1})}, soft, {0, -10});
  scene.kinds = 3;  // soft, hard, floor
  scene.walls[0].kind = 2;
  scene.pairs = {soft, soft, soft, soft, hard, hard, soft, hard, soft};
  GrainStage settle{.name = "settle", .scene = scene, .steps = 20000};
  GrainStage renamed = named(settle, "renamed");
  renamed.bodies.renamed = {{in_box({2, 0}, {4, 1}), {1, 1}}};
  StagedSimulation staged({settle, renamed}, options_of(NormalLaw::linear_dashpot, 1e-3));
  const auto overlaps = [&] {
    std::vector<double> found;
    for (const GrainContact& contact : staged.present().contacts()) found.push_back(contact.overlap);
    return found;
  };
  run_to(staged, 20000);
  CHECK(overlaps()[0] == Approx(10.0 / 1000).epsilon(1e-9));
  CHECK(overlaps()[1] == Approx(10.0 / 1000).epsilon(1e-9));
  run_to(staged, 40000);
  CHECK(overlaps()[0] == Approx(10.0 / 1000).epsilon(1e-9));
  CHECK(overlaps()[1] == Approx(10.0 / 4000).epsilon(1e-9));
  CHECK(staged.reports()[1].renamed == 1);
}

TEST_CASE("stages_without_bodies_and_first_stages_that_change_them_are_refused") {
  const GrainOptions options = options_of(NormalLaw::linear_dashpot, 1e-3);
  const GrainScene scene =
      scene_of({ball({0, 0.5}, 0.5)}, {line("floor", {0, 0}, {0, 1})}, firm(NormalLaw::linear_dashpot));
  GrainStage first{.name = "first", .scene = scene, .steps = 10}, next = named(first, "next");
  const auto refused = [&](const std::vector<GrainStage>& stages, const std::string& word) {
    check_refused(
        [&] {
          StagedSimulation staged(stages, options);
          run_to(staged, 20);
        },
        {word});
  };
  next.bodies.removed = {in_box({-1, -1}, {1, 1})};
  refused({next}, "it is the first");
  refused({first, next}, "all bodies are removed");
  next.bodies = {};
  next.bodies.added = {ball({0.1, 0.5}, 0.5)};
  refused({first, next}, "inside one another");
  next.bodies.added = {ball({5, -0.5}, 0.5)};
  refused({first, next}, "behind wall");
}
