// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A step that would let bodies pass through one another is refused before it happens.
#include <cstdlib>
#include <numbers>

#include "grains/scenes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Passing {
  std::string name;
  GrainScene scene;
  std::string other;  // as it is called
  double step = 1;
};

PairProperties stiff(NormalLaw law) {
  PairProperties pair = one_second(law, 1);
  pair.stiffness *= 1e4;  // contacts last a hundredth of a step
  return pair;
}

/// Bodies that go several radii in a step of one second towards something small, thin or moving.
std::vector<Passing> passings(NormalLaw law) {
  std::vector<Passing> all;
  const PairProperties pair = stiff(law);
  const Wall floor = line("floor", {0, 0}, {0, 1});
  const Wall plate = segment("plate", {-1, 0}, {1, 0});
  Wall ram = line("ram", {0, 0}, {0, 1});
  ram.move_y = {Schedule::Kind::table, 0, 0, 0, 0, {0, 10}, {0, 40}};
  all.push_back({"a line", scene_of({ball({0, 2}, 1, {0, -4})}, {floor}, pair), "wall \"floor\""});
  all.push_back({"a segment", scene_of({ball({0.3, 2}, 1, {0, -4})}, {plate}, pair), "wall \"plate\""});
  all.push_back({"a wall that comes", scene_of({ball({0, 2}, 1, {0, 0})}, {ram}, pair), "wall \"ram\""});
  all.push_back({"a grain", scene_of({ball({0, 0}, 1, {}), ball({5, 0.1}, 1, {-10, 0})}, {}, pair), "grain 1"});
  all.push_back({"a small grain", scene_of({ball({0, 0}, 0.1, {}), ball({2, 0.1}, 1, {-4, 0})}, {}, pair), "grain 1"});
  all.push_back({"gravity that moves diameters in a step", scene_of({ball({0, 3}, 1, {0, 0})}, {floor}, pair, {0, -20}),
                 "wall \"floor\""});
  return all;
}

/// "Use a step below X s": X.
double step_that_would_do(const Refusal& refusal) {
  const std::size_t at = refusal.remedy.find("below ");
  return at == std::string::npos ? 0 : std::atof(refusal.remedy.c_str() + at + 6);
}

}  // namespace

TEST_CASE("what_would_pass_unseen_is_refused_with_the_step_that_would_do") {
  const NormalLaw law = GENERATE(from_range(all_laws));
  for (const Passing& passing : passings(law)) {
    if (law == NormalLaw::exact_flow) continue;  // sees what happens within a step
    GrainScene scene = passing.scene;
    if (is_map(law)) scene.pairs[0] = {.dimensionless = 0.5};
    GrainSimulation simulation(scene, options_of(law, 1));
    CAPTURE(to_string(law), passing.name);
    const Refusal refusal =
        check_refused([&] { simulation.advance(3); }, {"step ", "grain 0", passing.other, "pass through"},
                      ErrorKind::computation_failed);
    const double step = step_that_would_do(refusal);
    CHECK(step > 0.01);
    CHECK(step < 1);
  }
}

TEST_CASE("a_body_that_would_turn_past_a_wall_or_a_body_within_a_step_is_refused_one_apart_is_not") {
  const Stepping stepping = GENERATE(Stepping{NormalLaw::linear_dashpot, GrainIntegrator::semi_implicit_euler},
                                     Stepping{NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet});
  const bool on_wall = GENERATE(false, true), clump = GENERATE(false, true), near = GENERATE(false, true);
  // a whole turn a step, with the long axis along the surface at both ends of it
  const double step = 1e-3, distance = near ? 1.2 : 2.5;
  Grain body = ball({0, distance}, 1, {}, 1, 0.5);
  body.spin = 2 * std::numbers::pi / step;
  GrainScene scene = scene_of({body}, {}, {.stiffness = 1, .restitution = 1});
  if (clump) {
    scene.clumps = {{{{{-1, 0}, 1}, {{1, 0}, 1}}}};
    scene.grains[0].clump = 0;
    scene.grains[0].radius = 2;
  } else {
    scene.grains[0].radius = 2;
    scene.grains[0].short_half_axis = 1;
  }
  if (on_wall) {
    scene.walls = {line("floor", {0, 0}, {0, 1})};
  } else {
    scene.grains.push_back(ball({0, -1}, 1));
  }
  GrainSimulation simulation(scene, options_of(stepping, step));
  CAPTURE(stepping.name(), on_wall, clump, near);
  if (!near) {
    simulation.advance(3);
    CHECK(simulation.grains()[0].angle == Approx(3 * 2 * std::numbers::pi));
    return;
  }
  const Refusal refusal = check_refused([&] { simulation.advance(1); },
                                        {"grain 0 would turn past", on_wall ? "floor" : "grain 1", "6.283 rad"},
                                        ErrorKind::computation_failed);
  CHECK(step_that_would_do(refusal) == Approx(step * 0.1 / (2 * std::numbers::pi)).epsilon(0.01));
}

TEST_CASE("exact_flow_sees_what_happens_within_a_step_or_refuses_it") {
  for (const Passing& passing : passings(NormalLaw::exact_flow)) {
    CAPTURE(passing.name);
    GrainSimulation simulation(passing.scene, options_of(NormalLaw::exact_flow, 1));
    try {
      simulation.advance(2);
      const EnergyLedger ledger = simulation.energy();
      CAPTURE(ledger.error(), ledger.initial);
      CHECK(simulation.counters().contacts > 0);
      CHECK(std::abs(ledger.error()) < 1e-12 * std::max(1.0, ledger.initial));
    } catch (const Error& error) {
      CHECK_THAT(error.what(), Catch::Contains("would pass through " + passing.other));
    }
  }
}

TEST_CASE("a_refused_step_leaves_the_state_before_it") {
  // A busy box; a bullet comes, that a step would carry through a disc, wherever its last step began.
  const Stepping stepping = GENERATE(from_range(all_steppings));
  int refused = 0;
  for (const double start : {40.0, 40.2, 40.4, 40.6}) {
    GrainScene scene = busy_box(stepping.law, 3, 3, 31);
    scene.walls.pop_back();
    scene.walls.pop_back();
    scene.grains.push_back(ball({start, 1.5}, 0.05, {-37.3, 0}));
    scene.walls.push_back(line("shield", {-5, 0}, {1, 0}));
    GrainSimulation simulation(scene, options_of(stepping, 0.02));
    for (int k = 0; k < 100; ++k) {
      const Bits before = bits_of(simulation);
      const SavedState state = simulation.save();
      try {
        simulation.advance(1);
        continue;
      } catch (const Error& error) {
        ++refused;
        CAPTURE(stepping.name(), start, error.what(), simulation.step());
        CHECK(simulation.step() == k);
        CHECK(bits_of(simulation) == before);
        const SavedState after = simulation.save();
        for (const char* name : {"contacts", "impulses", "bonds", "counters"}) CHECK(after[name] == state[name]);
        CHECK_THROWS_WITH(simulation.advance(1), error.what());
        CHECK(bits_of(simulation) == before);
        break;
      }
    }
  }
  CAPTURE(stepping.name(), refused);
  CHECK((refused > 0 || stepping.law == NormalLaw::exact_flow));
}

TEST_CASE("who_asks_for_it_may_let_bodies_pass") {
  const NormalLaw law = GENERATE(NormalLaw::linear_dashpot, NormalLaw::hertz_dashpot);
  GrainOptions options = options_of(law, 1);
  options.refuse_crossing = false;
  GrainSimulation simulation(passings(law)[3].scene, options);
  CHECK_NOTHROW(simulation.advance(3));
  CHECK(simulation.grains()[1].position.x < simulation.grains()[0].position.x);
}

TEST_CASE("a_motion_that_is_no_number_is_refused") {
  const auto bodies =
      GENERATE(std::vector{ball({0, 0.9}, 1, {0, 0})}, std::vector{ball({0, 2}, 1, {0, 0}), ball({0, 3.9}, 1, {0, 0})});
  GrainScene scene = scene_of(bodies, {line("floor", {0, 0}, {0, 1})}, {.stiffness = 1e308});
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 1e10));
  CHECK_THROWS_WITH(simulation.advance(2), Catch::Contains("step 0"));
  CHECK(simulation.step() == 0);
}
