// SPDX-License-Identifier: GPL-3.0-or-later
// Runs that LAMMPS keeps as references of its granular package: unittest/granular/tests/*.yaml of
// github.com/lammps/lammps, states printed by LAMMPS (4 Jul 2026, dem03: 30 Mar 2026) to 17 digits. Spheres in a plane;
// velocity Verlet with the damping of the velocity at half a step, contacts that end at zero overlap.
#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"
#include "equidem/material/inertia.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr Stepping hooke{NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet};
constexpr Stepping hertz{NormalLaw::hertz_dashpot, GrainIntegrator::velocity_verlet};
/// Positions and velocities agree to this: all that 17 digits and another order of additions leave over a run.
constexpr double round_off = 1e-13;

Grain sphere(double diameter, double density, Vec2 position, Vec2 velocity = {}) {
  Grain grain;
  grain.position = position;
  grain.velocity = velocity;
  grain.radius = diameter / 2;
  grain.inertia = inertia_of(diameter / 2, density, Body::sphere);
  return grain;
}

PairProperties as_lammps(double stiffness, double restitution) {
  PairProperties pair;
  pair.stiffness = stiffness;
  pair.restitution = restitution;
  pair.end = ContactEnd::at_zero_overlap;
  return pair;
}

/// What LAMMPS printed after so many steps more.
struct Printed {
  std::int64_t steps;
  double place, velocity;
};

std::string apart(std::int64_t step, double value, double printed) {
  return fmt::format("step {}: {:.17g}, LAMMPS {:.17g}, apart by {:.2g}\n", step, value, printed, value - printed);
}

/// Two spheres that meet head on in x: the state of the second.
void meet_head_on(const Stepping& stepping, const PairProperties& pair, const Grain& right, double step,
                  const std::vector<Printed>& states) {
  Grain left = right;
  left.position = -right.position;
  left.velocity = -right.velocity;
  GrainSimulation simulation(scene_of({left, right}, {}, pair), options_of(stepping, step));
  for (const Printed& state : states) {
    simulation.advance(state.steps);
    const Grain now = simulation.grains()[1];
    INFO(apart(simulation.step(), now.position.x, state.place)
         << apart(simulation.step(), now.velocity.x, state.velocity));
    CHECK(std::abs(now.position.x - state.place) <= round_off * state.place);
    CHECK(std::abs(now.velocity.x - state.velocity) <= round_off * std::abs(right.velocity.x));
  }
}

}  // namespace

TEST_CASE("lammps_dem01_spheres_rebound_with_half_their_speed") {  // dem01-hooke-2d-lj.yaml
  meet_head_on(hooke, as_lammps(1e4, 0.5), sphere(1, 1, {0.55, 0}, {-1, 0}), 1e-4,
               {{947, 0.51414816868621493, 0.50042582133180780}, {500, 0.53916945975278863, 0.50042582133180780}});
}

TEST_CASE("lammps_dem01_spheres_rebound_with_four_fifths_of_their_speed") {  // dem01-hooke-twosphere-e08-3d-si.yaml
  meet_head_on(hooke, as_lammps(1e6, 0.8), sphere(0.005, 2700, {0.00255, 0}, {-2, 0}), 3e-8,
               {{2068, 2.5118996608531133e-03, 1.5997548989987018}, {727, 2.5467903152001660e-03, 1.5997548989987018}});
}

TEST_CASE("lammps_dem02_hertz_spheres_through_their_deepest_overlap") {  // dem02-hertz-peak-3d-si.yaml
  meet_head_on(hertz, as_lammps(3.33333e10 * std::sqrt(0.005), 1), sphere(0.02, 2800, {0.0101, 0}, {-10, 0}), 2e-8,
               {{500, 9.9999999999997261e-03, -10.0},
                {1008, 9.8629436218504573e-03, -8.8771553283535053e-03},
                {1000, 9.9982053375566714e-03, 9.9999015425187849}});
}

TEST_CASE("lammps_dem03_a_hertz_sphere_rebounds_from_a_wall") {  // dem03-hertz-peak-wall-3d-si.yaml
  GrainSimulation simulation(scene_of({sphere(0.005, 7000, {0, 0.00255}, {0, -3.9})}, {line("floor", {0, 0}, {0, 1})},
                                      as_lammps(7.11111e10 * std::sqrt(0.0025), 1)),
                             options_of(hertz, 1e-8));
  for (const Printed& state : {Printed{1300, 2.4993000166951690e-03, -3.8996733777045449},
                               Printed{838, 2.4773193520144258e-03, 9.2769893463961334e-04},
                               Printed{900, 2.5017266321382694e-03, 3.9000000198694948}}) {
    simulation.advance(state.steps);
    const Grain now = simulation.grains()[0];
    INFO(apart(simulation.step(), now.position.y, state.place)
         << apart(simulation.step(), now.velocity.y, state.velocity));
    CHECK(std::abs(now.position.y - state.place) <= round_off * state.place);
    CHECK(std::abs(now.velocity.y - state.velocity) <= round_off * 3.9);
  }
}

TEST_CASE("lammps_dem03_two_spheres_squeezed_between_walls") {  // dem03-elastic-3d-si.yaml; MFiX-DEM case 3 (Garg et
                                                                // al. 2012)
  GrainSimulation simulation(
      scene_of({sphere(0.001, 1e4, {0, 0.00045}), sphere(0.001, 1e4, {0, 0.00135})},
               {line("floor", {0, 0}, {0, 1}), line("lid", {0, 0.0018}, {0, -1})}, as_lammps(1e3, 1), {0, -9.81}),
      options_of(hooke, 2e-6));
  const Printed states[][2] = {
      {{200, 4.1684173029886483e-04, 6.0382831813026297e-02}, {200, 1.3831303477676166e-03, -5.9409910101324431e-02}},
      {{400, 4.4919993452677758e-04, -1.1772563285642577e-01}, {400, 1.3507035560466720e-03, 1.1914259797246207e-01}},
      {{600, 4.1825802027107992e-04, 1.7483079908222401e-01}, {600, 1.3815735012746196e-03, -1.7374004998063819e-01}},
      {{800, 4.4695822989225211e-04, -2.2609762372881306e-01}, {800, 1.3528370633113184e-03, 2.2626922777377567e-01}},
      {{1000, 4.2108853140521607e-04, 2.7253050689536862e-01},
       {1000, 1.3787259677965739e-03, -2.7337133152454407e-01}}};
  for (const auto& both : states) {
    simulation.advance(200);
    REQUIRE(simulation.step() == both[0].steps);
    for (std::size_t k = 0; k < 2; ++k) {
      const Grain now = simulation.grains()[k];
      INFO(apart(simulation.step(), now.position.y, both[k].place)
           << apart(simulation.step(), now.velocity.y, both[k].velocity));
      CHECK(std::abs(now.position.y - both[k].place) <= round_off * both[k].place);
      CHECK(std::abs(now.velocity.y - both[k].velocity) <= round_off);
    }
  }
  const EnergyLedger ledger = simulation.energy();
  INFO(fmt::format("energy: {:.3g} of what there was", ledger.error() / ledger.initial));
  CHECK(std::abs(ledger.error()) < 5e-4 * ledger.initial);  // analytic_tol of the file
}

namespace {

/// While the sphere slides friction is mu N, whatever the tangential spring and dashpot: there LAMMPS and we do the
/// same. The laws differ in what the spring keeps once it sticks again, and where the normal force attracts.
struct Moving {
  Vec2 velocity;
  double spin;
};

}  // namespace

TEST_CASE("lammps_dem05_a_sliding_sphere_begins_to_roll") {  // dem05-sliptime-3d-si.yaml
  constexpr double mu = 0.4, g = 1, u0 = 1.4, radius = 0.0025, step = 1e-5, stiffness = 1e4, height = 0.002499982;
  PairProperties pair = as_lammps(stiffness, 1);
  pair.friction = mu;
  pair.tangential_ratio = 0.28;
  Grain grain = sphere(2 * radius, 2700, {0, height}, {u0, 0});
  // LAMMPS evaluates no tangential force before the first step: its first half kick lacks friction.
  const double friction = mu * stiffness * (radius - height);
  grain.velocity.x += 0.5 * step * friction / grain.inertia.mass;
  grain.spin += 0.5 * step * friction * radius / grain.inertia.moment;
  GrainSimulation simulation(scene_of({grain}, {line("floor", {0, 0}, {0, 1})}, pair, {0, -g}),
                             options_of(hooke, step));
  const Moving printed[] = {{{1.2400019628833119, 1.8574987052190495e-07}, 1.5999803711667499e+02},
                            {{1.1200010578590238, 2.4483105283529637e-06}, 2.7999894214094314e+02},
                            {{1.0000022220127893, -4.6207390105925522e-07}, 3.9999777798717338e+02}};
  for (int k = 0; k < 3; ++k) {
    simulation.advance(k == 0 ? 40000 : 30000);
    const Grain now = simulation.grains()[0];
    // Spins are counter-clockwise here: a sphere that rolls to the right turns clockwise.
    INFO(apart(simulation.step(), now.velocity.x, printed[k].velocity.x)
         << apart(simulation.step(), now.velocity.y, printed[k].velocity.y)
         << apart(simulation.step(), -now.spin, printed[k].spin));
    CHECK(std::abs(now.velocity.x - printed[k].velocity.x) < 1e-12);
    CHECK(std::abs(now.velocity.y - printed[k].velocity.y) < 1e-12);
    CHECK(std::abs(-now.spin / printed[k].spin - 1) < 1e-12);
    CHECK(now.velocity.x == Approx(u0 - mu * g * simulation.time()).epsilon(1e-5));
  }
  // it slides until t = 2 u0/(7 mu g), and rolls with 5 u0/7 from then on, but for what the spring swings that slip
  // leaves stretched
  REQUIRE(simulation.time() == Approx(2 * u0 / (7 * mu * g)));
  simulation.advance(20000);
  const Grain rolling = simulation.grains()[0];
  const double mass = grain.inertia.mass, tangential_mass = 2 * mass / 7;
  const double swing = mu * mass * g / std::sqrt(pair.tangential_ratio * stiffness * tangential_mass);
  CAPTURE(rolling.velocity.x, rolling.spin, swing);
  CHECK(std::abs(rolling.velocity.x - 5 * u0 / 7) < 2 * swing / 7);
  CHECK(std::abs(rolling.velocity.x + rolling.spin * radius) < swing);
}
