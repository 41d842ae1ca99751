// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sukegawa (2010), chapter 8: scene, shaking and measures of `equidem-papers sukegawa2010`.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/fields/spectrum.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/shaking.hpp"
#include "equidem/material/wave_speed_springs.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/size_distribution.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr double width = 0.165;

/// Rows of five bodies above a box.
GrainScene start_of(PackingShape::Kind shape) {
  const SettlingOptions material{.springs = springs_of_wave_speeds(2480, wave_speeds_from_shear(50, 0.25)),
                                 .damping = 1};
  Random random(1);
  Bodies bodies;
  bodies.radii = draw_radii({.smallest = 0.005, .largest = 0.01}, 20, random);
  for (int k = 0; k < 20; ++k) {
    const double row = k / 4, column = k % 4;
    bodies.centres.push_back({0.041 * (column + 0.5), 0.041 * (row + 0.5)});
    if (shape != PackingShape::Kind::disc) bodies.turns.push_back(random.uniform());
  }
  GrainPacking packing;
  make_grains({.kind = shape}, bodies, 2480, packing);
  GrainScene scene = scene_of_box(width, material);
  scene.grains = packing.grains;
  scene.clumps = packing.clumps;
  scene.bonds = packing.bonds;
  for (GrainBond& bond : scene.bonds) bond.normal_dashpot = bond.tangential_dashpot = 1e4;
  return scene;
}

constexpr GrainOptions options{
    .law = NormalLaw::linear_dashpot, .integrator = GrainOptions::Integrator::velocity_verlet, .time_step = 1e-5};

/// The largest difference in place, over the smallest radius.
double apart(const std::vector<Grain>& a, const std::vector<Grain>& b) {
  double largest = 0;
  for (std::size_t g = 0; g < a.size(); ++g) largest = std::max(largest, norm(a[g].position - b[g].position) / 0.005);
  return largest;
}

}  // namespace

TEST_CASE("a_box_filled_once_is_shaken_as_if_it_had_been_one_run") {
  const auto shape = GENERATE(PackingShape::Kind::disc, PackingShape::Kind::ellipse, PackingShape::Kind::bonded_pair,
                              PackingShape::Kind::rigid_pair);
  CAPTURE(to_string(shape));
  constexpr std::int64_t filling = 30'000, shaking = 15'000;
  GrainScene shaken = start_of(shape);
  // Forces at the end of a step are computed with the walls at the next step.
  shake(shaken.walls, {1, 0}, harmonic_shaking(8, 10, (filling + 1) * options.time_step, 1));
  GrainSimulation whole(shaken, options);
  whole.advance(filling);
  const auto at_rest = whole.grains();
  whole.advance(shaking);

  GrainSimulation fill(start_of(shape), options);
  fill.advance(filling);
  GrainSimulation rest(shaken, options);
  rest.restore(fill.save());
  CHECK(apart(rest.grains(), at_rest) == 0);
  rest.advance(shaking);
  CHECK(apart(rest.grains(), whole.grains()) == 0);

  GrainSimulation standing(start_of(shape), options);
  standing.restore(fill.save());
  standing.advance(shaking);
  CHECK(apart(standing.grains(), whole.grains()) > 0.01);
}
