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
  const Scene scene{.assembly = assembly,
                    .springs = springs,
                    .inertia = inertia_of(assembly.radii, 1, Body::disc),
                    .velocities = start_with(random_motions(assembly.size(), 1, 1e-6, 1e-6))};
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
  Scene scene{.assembly = assembly, .springs = springs, .inertia = inertia_of(assembly.radii, 1, Body::disc)};
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
