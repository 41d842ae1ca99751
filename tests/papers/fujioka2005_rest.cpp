// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Limits of the laws of Fujioka & Ushijima (2005): rest and clusters, beside exact_flow.
#include <cmath>

#include "papers/fujioka2005_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace fujioka2005;

namespace {

constexpr double rest_step = 1e-3;

/// Means over the last steps.
struct Late {
  double speed = 0;    ///< rms, of g dt
  double overlap = 0;  ///< with the floor, of the static one of a linear spring
};

Late settle(const PairProperties& pair, NormalLaw law, int balls, int steps) {
  const GrainScene scene = column(pair, balls);
  GrainSimulation run = start(scene, law, rest_step);
  run.advance(steps);
  constexpr int watched = 1000;
  Late late;
  for (int k = 0; k < watched; ++k) {
    run.advance(1);
    const auto grains = run.grains();
    for (const Grain& grain : grains) late.speed += dot(grain.velocity, grain.velocity) / (watched * balls);
    late.overlap += (0.5 * diameter - grains[0].position.y) / watched;
  }
  late.speed = std::sqrt(late.speed) / (gravity * rest_step);
  late.overlap *= pair.dimensionless / (balls * gravity * rest_step * rest_step);
  return late;
}

}  // namespace

TEST_CASE("a_ball_rests_at_its_weight_over_its_stiffness_by_forces_and_exact_flow") {
  const NormalLaw law = GENERATE(NormalLaw::linear_dashpot, NormalLaw::exact_flow);
  const double a = GENERATE(0.05, 0.1, 0.3);
  PairProperties pair = pair_of(law);
  pair.dimensionless = a;
  const Late late = settle(pair, law, 1, 6000);
  CAPTURE(describe(law).letter, a, late.speed, late.overlap);
  CHECK(late.speed < 1e-8);
  CHECK(late.overlap == Approx(1).epsilon(1e-6));
}

TEST_CASE("a_ball_rests_by_the_maps_at_half_of_one_plus_a_of_that") {
  // (21) at s = 0 pushes with 2 a d/(1 + a), twice the spring's a d but for the step
  const NormalLaw law = GENERATE(NormalLaw::five_case_map, NormalLaw::energy_map);
  const double a = GENERATE(0.05, 0.1, 0.3);
  PairProperties pair = pair_of(law);
  pair.dimensionless = a;
  const Late late = settle(pair, law, 1, 6000);
  CAPTURE(describe(law).letter, a, late.speed, late.overlap);
  CHECK(late.overlap == Approx(0.5 * (1 + a)).epsilon(1e-6));
}

TEST_CASE("a_column_comes_to_rest_by_exact_flow_and_never_by_the_maps") {
  constexpr int balls = 5, steps = 15000;
  PairProperties stiff = pair_of(NormalLaw::exact_flow);
  stiff.dimensionless = 4;
  for (const PairProperties& pair : {pair_of(NormalLaw::exact_flow), stiff}) {
    const Late late = settle(pair, NormalLaw::exact_flow, balls, steps);
    CAPTURE(pair.dimensionless, late.speed, late.overlap);
    CHECK(late.speed < 1e-4);
    CHECK(late.overlap == Approx(1).epsilon(1e-6));
  }
  for (const NormalLaw law : {NormalLaw::five_case_map, NormalLaw::energy_map}) {
    const Late late = settle(pair_of(law), law, balls, steps);
    CAPTURE(describe(law).letter, late.speed, late.overlap);
    CHECK(late.speed > 0.5);
    CHECK(late.overlap < 0.5);
  }
}

TEST_CASE("balls_that_lose_nothing_keep_their_energy_by_exact_flow_better_than_by_maps") {
  // (kinetic + elastic + potential)/(its start), the potential over the floor
  const auto change = [](NormalLaw law) {
    const GrainScene scene = column(pair_of(law, 1), 5);
    GrainSimulation run = start(scene, law, rest_step);
    double start_height = 0;
    for (int k = 1; k <= 5; ++k) start_height += k * drop * diameter;
    const double start_energy = scene.grains[0].inertia.mass * gravity * start_height;
    run.advance(20000);
    const EnergyLedger energy = run.energy();
    return std::abs((energy.kinetic + energy.elastic_normal + energy.potential) / start_energy);
  };
  const double x = change(NormalLaw::exact_flow), p = change(NormalLaw::energy_map);
  CAPTURE(x, p);
  CHECK(x < 1e-4);
  CHECK(p > 10 * x);
}
