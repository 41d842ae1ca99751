// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that stages remove, rename and add.
#include "equidem/grains/contacts/bonds.hpp"

#include "grains/bonded_scenes.hpp"
#include "grains/resuming.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

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

}  // namespace

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
  GrainStage alone = both;
  alone.name = "alone";
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
  GrainScene scene = busy_box(stepping.law, 4, 3, 3);
  for (Wall& wall : scene.walls) wall.move_x = wall.move_y = {};
  GrainStage more{.name = "more", .scene = scene, .steps = 150};
  more.scene.grains.insert(more.scene.grains.begin() + 5, ball({2, 20}, 0.4));
  more.scene.grains.push_back(ball({3, 30}, 0.4));
  more.scene.gravity = scene.gravity;
  more.scene.walls.pop_back();  // the lid
  GrainScene open = scene;
  open.walls.pop_back();
  GrainStage fewer = more;
  fewer.name = "fewer";
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

TEST_CASE("the_ledger_closes_over_stages_that_remove_rename_and_add_bodies") {
  // maps make energy where several contacts act on a body
  const Stepping stepping =
      GENERATE(filter([](const Stepping& s) { return !is_map(s.law); }, from_range(stage_steppings)));
  std::vector<double> errors;
  for (const int finer : {1, 8}) {
    StagedSimulation staged(changing_stages(busy_box(stepping.law, 4, 3, 3), 300 * finer),
                            options_of(stepping, 1e-3 / finer));
    while (!staged.over()) {
      staged.advance(300 * finer);
      if (staged.over()) break;
      const EnergyLedger before = staged.energy();
      staged.advance(0);  // the next stage begins
      const EnergyLedger after = staged.energy();
      CAPTURE(stepping.name(), finer, staged.step(), before.error(), after.error());
      CHECK(std::abs(after.error() - before.error()) <= 1e-12 * before.largest());
      CHECK(std::abs(after.work_of_stages - before.work_of_stages) > 0.01);
    }
    errors.push_back(std::abs(staged.energy().error()) / staged.energy().largest());
    CHECK(staged.reports()[1].removed == 2);
    CHECK(staged.reports()[1].renamed > 2);
    CHECK(staged.reports()[2].removed > 0);
    CHECK(staged.reports()[2].added == 2);
    CHECK(staged.motions().size() == 14);
  }
  CAPTURE(stepping.name(), errors);
  CHECK(errors[0] <= 2e-3);
  CHECK(errors[1] <= 0.4 * errors[0] + 1e-12);
}

TEST_CASE("stages_that_change_bodies_go_on_from_any_saved_state_with_the_same_bits") {
  const Stepping stepping = GENERATE(from_range(stage_steppings));
  const int scene_kind = GENERATE(0, 1, 2);  // discs, bonded discs, ellipses and clumps
  if (scene_kind > 0 && !gives_force(stepping.law)) return;
  GrainScene scene = scene_kind == 2 ? mixed_box(stepping.law, 4, 3, 5) : busy_box(stepping.law, 4, 3, 5);
  if (scene_kind == 1) {
    for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 4}, {5, 8}, {6, 7}, {9, 10}, {10, 11}})
      scene.bonds.push_back(
          {.i = i, .j = j, .normal_dashpot = 1, .normal_spring = 300, .tangential_spring = 100, .bending_spring = 5});
    scene.strengths = ContactStrengths{{14, 9, 99, 9, 14, 14}, {9, 5, 99, 5, 9, 9}, 0.2};
  }
  const StagedSimulation whole = check_resuming(changing_stages(scene, 60), options_of(stepping, 4e-3), 7);
  CAPTURE(stepping.name(), scene_kind, whole.present().present_grains().size(), whole.breaks().size());
  if (scene_kind != 1) return;
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
  GrainStage rest = whole;
  rest.name = "rest";
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
  GrainStage meet = wait;
  meet.name = "meet";
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
  GrainStage renamed = settle;
  renamed.name = "renamed";
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
  GrainStage first{.name = "first", .scene = scene, .steps = 10}, next = first;
  next.name = "next";
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
