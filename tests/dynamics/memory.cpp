// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What a run keeps for each disc.
#include "dynamics/moving_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("small_motions_keep_300_bytes_a_disc_in_the_loop") {
  const bool hexagonal = GENERATE(true, false);
  DelaunayOptions random;
  random.discs = 10000;
  random.radii = {0.5, 0.5};
  const Assembly assembly =
      hexagonal ? hexagonal_lattice({.columns = 100, .rows = 100, .radius = 0.5}) : delaunay_assembly(random);
  const ContactSprings springs(SpringConstants{1, 0.4});
  const Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  const Simulation run(scene, {.time_step = 0.1});
  CAPTURE(hexagonal, assembly.size(), run.bytes_per_body());
  CHECK(run.bytes_per_body() <= 300);
}
