// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Motion that came to rest is the solution of the stiffness matrix.
#include <algorithm>
#include <numbers>

#include "equidem/dynamics/relaxation.hpp"
#include "equidem/dynamics/time_step.hpp"
#include "equidem/homogenize/tension_test.hpp"

#include "dynamics/moving_scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/motions.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Tension {
  TensionSetup setup;
  equidem::Scene scene;

  Tension(const Assembly& assembly, const ContactSprings& springs)
      : setup(tension_setup(assembly, {})), scene(assembly, springs, inertia_of(assembly.radii, 2600, Body::disc)) {
    scene.supports = held_still(assembly, setup.supports);
    scene.loads = lasting(setup.loads);
  }
};

}  // namespace

TEST_CASE("every_held_scene_relaxes_under_prescribed_motions_and_loads") {
  for (const HeldScene& held : held_scenes()) {
    const Assembly& assembly = held.assembly();
    if (held.springs.any_negative()) continue;
    std::vector<Support> supports = held.supports;
    supports.front().ux = 1e-3;
    const LoadCase loads = {{"a", LoadKind::per_disc, {1e5, -2e5}, 0}};
    const Equilibrium exact = solve_equilibrium(assembly, held.springs, supports, loads, held.options);
    equidem::Scene scene(assembly, held.springs, {});
    scene.supports = held_still(assembly, supports);
    scene.loads = lasting(loads);
    CAPTURE(held.name);
    RelaxationOptions options{.rotation = held.options.rotation, .tolerance = 1e-12};
    // Displacements of a slender strip are so large beside stretches that their rounding alone leaves more.
    if (held.name.find("strip") != std::string::npos) options.tolerance = 2e-11;
    const Relaxation rest = relax(scene, options);
    const double difference = relative_difference(assembly, rest.motions, exact.motions);
    CAPTURE(rest.report(), difference);
    CHECK(difference < 1e-10);
  }
}

// How much the method is worth: the same block by damped motion in time.
TEST_CASE("damped_motion_comes_to_the_same_rest_in_many_more_steps") {
  const Assembly assembly = hexagonal_block(15);
  const ContactSprings springs(SpringConstants{1e9, 0.5e9});
  const Tension tension(assembly, springs);
  const Relaxation rest = relax(tension.scene, {.tolerance = 1e-12});
  const Damping damping = GENERATE(Damping{.local = 0.7}, Damping{.mass = 300});
  SimulationOptions options{.damping = damping};
  options.time_step = choose_time_step(tension.scene, options).step;
  Simulation run(tension.scene, options);
  const ThreadsFor one(1);
  const Stopwatch watch;
  double unbalanced = 1;
  while (unbalanced > 1e-9 && run.step() < 100000) {
    run.advance(500);
    const std::vector<DiscMotion> u = run.motions();
    unbalanced = relative_unbalanced_force(tension.scene, options.motion, run.unbalanced_forces(u), u);
  }
  const double difference = relative_difference(assembly, run.motions(), rest.motions);
  CAPTURE(damping.local, damping.mass, unbalanced, run.step(), watch.seconds(), rest.report(), difference);
  CHECK(unbalanced <= 1e-9);
  CHECK(difference < 1e-5);
  CHECK(run.step() > 3 * rest.evaluations);
}

// A strip clamped at its left end, bent by a force at its right end until it stands far off: relaxation and damped
// motion agree where no matrix can tell.
TEST_CASE("a_bent_strip_relaxes_to_where_damped_motion_ends") {
  const Assembly strip = hexagonal_lattice({.columns = 10, .rows = 3, .radius = 0.5});
  const ContactSprings springs(SpringConstants{1, 0.5});
  equidem::Scene scene(strip, springs, inertia_of(strip.radii, 1, Body::disc));
  scene.supports = held_still(strip, std::vector<Support>{{"left", 0.0, 0.0, 0.0}});
  scene.loads = lasting({{"right", LoadKind::per_disc, {0, 0.003}, 0}});
  const Relaxation rest = relax(scene, {.motion = LoopKind::Motion::finite, .tolerance = 1e-11});
  SimulationOptions options{.motion = LoopKind::Motion::finite, .damping = {.mass = 0.05}};
  options.time_step = choose_time_step(scene, options, {.fraction = 0.5}).step;
  Simulation run(scene, options);
  const ThreadsFor one(1);
  run.advance(30000);
  const double difference = relative_difference(strip, run.motions(), rest.motions);
  const Relaxation small = relax(scene, {});
  const double of_small = relative_difference(strip, small.motions, rest.motions);
  CAPTURE(rest.report(), rest.motions.back().u.x, rest.motions.back().u.y, difference, of_small);
  CHECK(difference < 1e-8);
  CHECK(of_small > 0.05);  // the motion is far from small
}
