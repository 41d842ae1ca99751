// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Runs that went wrong are stopped, others are not.
#include "equidem/dynamics/watch.hpp"

#include "equidem/dynamics/time_step.hpp"

#include "dynamics/moving_scenes.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("a_runaway_stops_with_step_disc_and_cause") {
  const Assembly assembly = hexagonal_block(5);
  const bool negative = GENERATE(false, true);
  const auto motion = GENERATE(LoopKind::Motion::small, LoopKind::Motion::finite);
  const ContactSprings springs(SpringConstants{1, negative ? -0.2 : 0.5});
  Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  start_with(scene, random_motions(assembly.size(), 1, 1e-6, 1e-6));
  SimulationOptions options{.motion = motion};
  const TimeStep chosen = choose_time_step(scene, options, {.allow_unstable = true});
  options.time_step = negative ? chosen.step : 1.1 * chosen.critical;
  Simulation run(scene, options);
  RunawayWatch watch(scene, options, {.critical_step = chosen.critical, .growth_rate = chosen.growth_rate});
  const Refusal refusal = refusal_of([&] {
    for (int k = 0; k < 200; ++k) {
      run.advance(10);
      watch.look(run);
    }
  });
  CAPTURE(negative, refusal.message);
  CHECK(refusal.kind == ErrorKind::computation_failed);
  CHECK(refusal.says("disc "));
  CHECK(refusal.says("step " + std::to_string(run.step())));
  CHECK(refusal.says(negative ? "kT is negative" : "1.1 times the critical one"));
}

TEST_CASE("a_sound_run_is_let_be") {
  const Assembly assembly = delaunay_block(60, 1);
  const ContactSprings springs(SpringConstants{1, 0.5});
  Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  scene.supports = held_still(assembly, std::vector<Support>{{"bottom", 0.0, 0.0, {}}});
  scene.loads = lasting({{"top", LoadKind::per_disc, {0.01, 0}, 0}});
  SimulationOptions options;
  options.time_step = choose_time_step(scene, options, {.fraction = 0.99}).step;
  Simulation run(scene, options);
  RunawayWatch watch(scene, options);
  for (int k = 0; k < 200; ++k) {
    run.advance(7);
    watch.look(run);
  }
  CHECK(run.energy().kinetic > 0);
}

TEST_CASE("bonded_discs_that_pass_through_each_other_stop_a_finite_motion") {
  const Assembly assembly = hexagonal_block(3);
  const ContactSprings springs(SpringConstants{1, 0.5});
  const auto watched = [&](double speed, LoopKind::Motion motion) {
    equidem::Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
    scene.velocities = {{"0", {speed, 0}, 0}};
    SimulationOptions options{.motion = motion};
    options.time_step = choose_time_step(scene, options, {.fraction = 0.1}).step;
    Simulation run(scene, options);
    RunawayWatch watch(scene, options);
    return refusal_of([&] {
      watch.look(run);
      for (int k = 0; k < 600; ++k) {
        run.advance(1);
        watch.look(run);
      }
    });
  };
  const Refusal sound = watched(0.05, LoopKind::Motion::finite);
  CAPTURE(sound.message);
  CHECK(sound.message.empty());
  CHECK(watched(1e3, LoopKind::Motion::small).message.empty());  // a linear problem of any size
  const Refusal fast = watched(1e3, LoopKind::Motion::finite), through = watched(2, LoopKind::Motion::finite);
  CAPTURE(fast.message, through.message);
  CHECK(fast.kind == ErrorKind::computation_failed);
  CHECK(fast.says("the bonded discs 0 and 1 move past each other"));
  CHECK(fast.says("at the start"));
  CHECK(through.says("pass through each other"));
  CHECK(through.says("step "));
}
