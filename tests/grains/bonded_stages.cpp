// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Runs in stages of discs that are bonded, or become so.
#include <map>

#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"

#include "grains/bonded_scenes.hpp"
#include "grains/resuming.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Under a lid that presses with 20 N.
/// \param aside weight of a disc to the right: contacts then carry tangential forces
GrainScene columns_to_bond(NormalLaw law, double aside = 0) {
  GrainScene scene = pressed_columns(law, 20, 0.3, 0.2, 4.01);
  scene.gravity = {aside, 0};
  return scene;
}

/// Columns are pressed, then bonded.
std::vector<GrainStage> press_and_bond(const GrainScene& scene, std::int64_t steps, double normal_spring = 3000) {
  const GrainStage press{.name = "press", .scene = scene, .steps = steps};
  std::vector<GrainStage> stages{press, named(press, "bond")};
  stages[1].bonds = StageBonds{
      .gap_tolerance = 0.01,
      .like = {.normal_dashpot = 5, .normal_spring = normal_spring, .tangential_spring = 1500, .bending_spring = 100}};
  return stages;
}

}  // namespace

/// Force of i on j in each pair of discs, and moment of all contacts and bonds on each disc.
struct LoadsOnDiscs {
  std::map<std::pair<std::int32_t, std::int32_t>, Vec2> forces;
  std::vector<double> moments;
  double largest_normal = 0, largest_tangential = 0, largest_moment = 0;  ///< moment: of one contact

  explicit LoadsOnDiscs(const GrainSimulation& simulation) : moments(simulation.grains().size()) {
    const std::vector<Grain> grains = simulation.grains();
    for (const BodyContact& c : simulation.body_contacts()) {
      const auto i = static_cast<std::size_t>(c.i);
      moments[i] += cross(c.arm, c.force) + c.bending_moment;
      if (c.j < 0) continue;
      const auto j = static_cast<std::size_t>(c.j);
      moments[j] += cross(c.arm - (grains[j].position - grains[i].position), -c.force) - c.bending_moment;
      forces[{c.i, c.j}] += -c.force;  // of the contact and of a bond beside it
      largest_normal = std::max(largest_normal, std::abs(c.normal_force));
      largest_tangential = std::max(largest_tangential, std::abs(c.tangential_force));
      largest_moment = std::max(largest_moment, std::abs(cross(c.arm, c.force)));
    }
  }
};

TEST_CASE("discs_that_are_bonded_under_load_stay_at_rest_and_keep_their_forces_and_moments") {
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  constexpr std::int64_t pressed = 150000;
  std::vector<GrainStage> stages = press_and_bond(columns_to_bond(stepping.law, 0.8), pressed);
  stages[1].steps = 400;
  const bool beside = GENERATE(false, true);  // the contact keeps the forces, or the bond takes them over
  if (beside) stages[1].bonds->strengths = {.tension = 1e90, .shear = 1e90, .after_breaking = AfterBreaking::parallel};
  StagedSimulation staged(stages, options_of(stepping, 2e-4));
  run_to(staged, pressed);
  const LoadsOnDiscs before(staged.present());
  const double kinetic = staged.energy().kinetic;
  run_to(staged, pressed + 1);
  const LoadsOnDiscs after(staged.present());
  double off = 0, off_moment = 0;
  for (const auto& [pair, force] : after.forces)
    off = std::max(off, norm(force - (before.forces.contains(pair) ? before.forces.at(pair) : Vec2{})));
  for (std::size_t g = 0; g < after.moments.size(); ++g)
    off_moment = std::max(off_moment, std::abs(after.moments[g] - before.moments[g]));
  CAPTURE(stepping.name(), beside, staged.reports()[1].bonds_made, before.largest_normal, before.largest_tangential,
          before.largest_moment, off, off_moment);
  CHECK(staged.reports()[1].bonds_made == 24);
  CHECK(before.largest_normal > 4);
  CHECK(before.largest_tangential > 0.3);
  CHECK(before.largest_moment > 0.1);
  CHECK(off < 1e-5 * before.largest_normal);
  CHECK(off < 1e-4 * before.largest_tangential);
  CHECK(off_moment < 1e-4 * before.largest_moment);
  run_to(staged, pressed + 400);
  const EnergyLedger ledger = staged.energy();
  CAPTURE(kinetic, ledger.kinetic, ledger.elastic(), ledger.error());
  CHECK(ledger.kinetic < 1e-9 * ledger.elastic());
  CHECK(std::abs(staged.walls()[3].force.y - 20) < 1e-4 * 20);
  const auto discs = std::ranges::count_if(staged.present().contacts(), [](const auto& c) { return c.j >= 0; });
  CHECK((discs > 0) == beside);  // else those with walls alone are left
}

TEST_CASE("stages_with_bonds_go_on_from_any_saved_state_with_the_same_bits") {
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  const bool at_start = GENERATE(true, false);  // bonds there are before the stage that makes others
  const AfterBreaking after = GENERATE(AfterBreaking::frictional, AfterBreaking::parallel);
  CAPTURE(stepping.name(), at_start, to_string(after));
  GrainScene scene = still(busy_box(stepping.law, 4, 3, 5));
  const GrainBond like{.i = 0, .j = 1, .normal_spring = 300, .tangential_spring = 100, .bending_spring = 5};
  if (at_start) scene.bonds = {like};
  if (at_start) scene.strengths = ContactStrengths{{14}, {9}, 0.2, after == AfterBreaking::parallel};
  GrainStage first{.name = "thrown", .scene = scene, .steps = 60};
  GrainStage tied = first, open = first;
  tied.name = "tied";
  tied.bonds =
      StageBonds{.gap_tolerance = 0.4,
                 .like = like,
                 .strengths = StrengthOptions{
                     .tension = 14, .shear = 9, .friction = 0.2, .weibull_modulus = 3.0, .after_breaking = after}};
  tied.bonds->like.normal_dashpot = 1;
  open.name = "open";
  open.scene.walls.pop_back();
  const StagedSimulation whole = check_resuming({first, tied, open}, options_of(stepping, 4e-3), 7);
  CAPTURE(whole.bonds().size(), whole.present().breaks().size());
  CHECK(whole.bonds().size() > 5);
  CHECK(whole.present().breaks().size() > 0);
  CHECK(whole.present().breaks().size() < whole.bonds().size());
}

TEST_CASE("grains_tied_by_dashpots_are_as_many_bodies_as_groups_of_bonds_that_are_left") {
  // three discs in a ring of three bonds, and one alone, on a floor
  GrainScene scene = scene_of(
      {ball({0, 0.5}, 0.5), ball({1, 0.5}, 0.5), ball({0.5, 0.5 + std::sqrt(0.75)}, 0.5), ball({3, 0.499}, 0.5)},
      {line("floor", {0, 0}, {0, 1})}, one_second(NormalLaw::linear_dashpot, 0.5));
  for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {0, 2}})
    scene.bonds.push_back({.i = i, .j = j, .normal_dashpot = 1});
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 1e-3));
  simulation.advance(1);
  const double pushed = simulation.contacts().front().normal_force;
  REQUIRE(simulation.contacts().size() == 1);
  const auto off = [&](std::size_t bonds) {
    return unbalance_of(simulation, std::span(scene.bonds).first(bonds), {}).mean;
  };
  CAPTURE(pushed, off(3), off(2), off(0));
  CHECK(off(3) == Approx(1.0 / 2).epsilon(1e-9));  // the force of one contact on one of two bodies
  CHECK(off(2) == Approx(1.0 / 2).epsilon(1e-9));
}

TEST_CASE("a_disc_that_only_spins_between_plates_with_friction_is_not_at_rest") {
  // The forces of the plates cancel; their moments do not.
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  const double friction = 0.3, pressed = 1e-3;
  PairProperties pair = one_second(stepping.law, 1);
  pair.stiffness *= 1000;
  pair.friction = friction;
  pair.tangential_ratio = 2;
  GrainScene scene = scene_of({ball({0, 0.5 - pressed}, 0.5)},
                              {line("floor", {0, 0}, {0, 1}), line("lid", {0, 1 - 2 * pressed}, {0, -1})}, pair);
  scene.grains[0].spin = 2;
  GrainSimulation simulation(scene, options_of(stepping, 1e-4));
  simulation.advance(10);
  const Unbalance off = unbalance_of(simulation, {}, {});
  const Grain spun = simulation.grains()[0];
  Vec2 force;
  for (const BodyContact& contact : simulation.body_contacts()) force += contact.force;
  CAPTURE(stepping.name(), spun.spin, norm(spun.velocity), force.x, force.y, off.mean);
  REQUIRE(simulation.contacts().size() == 2);
  REQUIRE(spun.spin > 1);
  REQUIRE(norm(force) < 1e-9 * norm(simulation.body_contacts()[0].force));
  // two forces mu N at the radius, over N sqrt(1 + mu²)
  CHECK(off.mean == Approx(2 * friction / std::sqrt(1 + friction * friction)).epsilon(1e-9));
  CHECK(off.largest == off.mean);
}

TEST_CASE("bonds_too_soft_for_the_force_of_their_contact_and_those_of_other_shapes_are_refused") {
  const GrainOptions options = options_of(NormalLaw::linear_dashpot, 2e-4);
  const GrainScene columns = columns_to_bond(NormalLaw::linear_dashpot);
  StagedSimulation soft(press_and_bond(columns, 20000, 1), options);
  run_to(soft, 20000);
  const Bits then = bits_of(soft.present());
  for (int k = 0; k < 2; ++k) {
    CHECK(check_refused([&] { soft.advance(1); }, {"too soft"}).where == "stage 'bond'");
    CHECK(bits_of(soft.present()) == then);  // the state is that before the stage
    CHECK(soft.reports().size() == 1);
    CHECK(soft.milestone() == 20000);
  }
  const auto refused = [&](const auto& change, const std::string& word, NormalLaw law = NormalLaw::linear_dashpot) {
    std::vector<GrainStage> stages = press_and_bond(columns, 20000);
    change(stages);
    check_refused([&] { StagedSimulation(stages, options_of(law, 2e-4)); }, {word});
  };
  refused([](std::vector<GrainStage>& s) { s[0].scene.grains[0].short_half_axis = 0.4; }, "no disc");
  refused([](std::vector<GrainStage>& s) { s[1].bonds->like = {}; }, "bond");
  refused([](std::vector<GrainStage>& s) { s[1].bonds->gap_tolerance = 2; }, "gap");
  refused([](std::vector<GrainStage>& s) { s[1].bonds->like.normal_spring = -1; }, "-1");
  refused([](std::vector<GrainStage>&) {}, "knows no bonds", NormalLaw::exact_flow);
  refused(
      [](std::vector<GrainStage>& s) {
        s[0].scene.bonds = {{.i = 0, .j = 1, .normal_spring = 1}};
        s[1].bonds->strengths = StrengthOptions{.tension = 1, .shear = 1};
      },
      "strengths");
}

TEST_CASE("a_saved_stage_with_bonds_or_bodies_that_the_run_lacks_is_refused") {
  const std::vector<GrainStage> stages = press_and_bond(columns_to_bond(NormalLaw::linear_dashpot), 10);
  StagedSimulation staged(stages, options_of(NormalLaw::linear_dashpot, 2e-4));
  run_to(staged, 15);
  const SavedState state = staged.save();
  const Bits then = bits_of(staged.present());
  REQUIRE(!state["stage_bonds"].empty());
  const double beyond = static_cast<double>(stages[0].scene.grains.size());
  // numbers of bodies and stages, in columns of arrays
  for (const auto& [array, column] : {std::pair{"stage_bonds", 0},
                                      {"stage_bonds", 1},
                                      {"stage_bonds", 2},
                                      {"stage_bodies", 0},
                                      {"stage_bodies", 1}}) {
    for (const double number : {-1e9, beyond, 0.5, 1e300, std::nan("")}) {
      SavedState damaged = state;
      damaged[array][static_cast<std::size_t>(column)] = number;
      CAPTURE(array, column, number);
      CHECK_THROWS_AS(staged.restore(damaged), Error);
      CHECK(bits_of(staged.present()) == then);
    }
  }
  SavedState empty = state;
  for (double& number : empty["stage_bodies"]) number = 0;
  CHECK_THROWS_AS(staged.restore(empty), Error);
  CHECK_NOTHROW(staged.restore(state));
  CHECK(bits_of(staged.present()) == then);
}

TEST_CASE("bonds_stiffer_than_the_step_bears_are_refused_where_they_are_made") {
  const GrainOptions options = options_of(NormalLaw::linear_dashpot, 2e-3);
  const std::vector<GrainStage> stages = press_and_bond(columns_to_bond(NormalLaw::linear_dashpot), 10, 1e7);
  StagedSimulation staged(stages, options);
  run_to(staged, 10);
  CHECK(check_refused([&] { staged.advance(1); }, {"limit"}).where == "stage 'bond'");
  const double likely = likely_step_limit(stages[0].scene.grains, *stages[1].bonds, GrainOptions::BondStep::exact);
  CAPTURE(likely);
  CHECK(likely < options.time_step);
}

TEST_CASE("a_bonded_pair_that_creeps_together_goes_on_into_the_next_stage") {
  // a dashpot alone: the upper disc sinks into the lower one
  const Stepping stepping = GENERATE(from_range(force_steppings));
  GrainScene scene = scene_of({ball({0, 0.999}, 1), ball({0, 2.999}, 1)}, {line("floor", {0, 0}, {0, 1})},
                              one_second(stepping.law, 0.3), {0, -1});
  scene.pairs[0].stiffness *= 1000;
  scene.bonds = {{.i = 0, .j = 1, .normal_dashpot = 1, .tangential_dashpot = 1, .rolling_dashpot = 1}};
  GrainSimulation simulation(scene, options_of(stepping, 1e-3));
  const auto distance = [&] { return simulation.grains()[1].position.y - simulation.grains()[0].position.y; };
  while (distance() > 0.9 && simulation.step() < 20000) simulation.advance(100);
  const double before = distance();
  CAPTURE(stepping.name(), before);
  REQUIRE(before < 1);
  GrainStage sink{.name = "sink", .scene = scene, .steps = simulation.step()}, float_on = named(sink, "float");
  float_on.scene.gravity = {};
  float_on.steps = 100;
  StagedSimulation staged({sink, float_on}, options_of(stepping, 1e-3));
  run_to(staged, sink.steps + 100);
  CHECK(staged.reports().size() == 2);
  const Bits end = bits_of(staged.present());

  // a state in which the stage began with two discs inside one another is gone on from
  StagedSimulation half({sink, float_on}, options_of(stepping, 1e-3));
  StagedSimulation resumed({sink, float_on}, options_of(stepping, 1e-3));
  run_to(half, sink.steps + 50);
  REQUIRE(half.reports().size() == 2);
  CHECK_NOTHROW(resumed.restore(half.save()));
  run_to(resumed, sink.steps + 100);
  CHECK(bits_of(resumed.present()) == end);

  float_on.bodies.added = {ball(staged.motions()[0].u, 1)};
  StagedSimulation added({sink, float_on}, options_of(stepping, 1e-3));
  CHECK(refusal_of([&] { run_to(added, sink.steps + 100); }).says("start inside one another"));
}
