// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs tied by dashpots (Sukegawa 2010, chapter 5).
#include <limits>

#include "equidem/contact/viscous_bond.hpp"
#include "equidem/grains/contacts/bond_step.hpp"

#include "grains/bonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// The rate of a scene of two along x, at the time given.
double separation_speed(const GrainSimulation& simulation) {
  const auto grains = simulation.grains();
  return grains[1].velocity.x - grains[0].velocity.x;
}

GrainScene parting_pair(NormalLaw law, double dashpot, double speed) {
  GrainScene scene = pair_scene(law, {.j = 1, .normal_dashpot = dashpot, .tangential_dashpot = dashpot});
  scene.grains[0].velocity = {-0.3 * speed, 0};
  scene.grains[1].velocity = {0.7 * speed, 0};
  return scene;
}

}  // namespace

TEST_CASE("the_speed_of_a_pair_decays_as_the_exponential_at_any_step") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  const double dashpot = 2, speed = 1e-3;
  const GrainScene scene = parting_pair(stepping.law, dashpot, speed);
  const double mass = 1 / (1 / scene.grains[0].inertia.mass + 1 / scene.grains[1].inertia.mass);
  const bool verlet = stepping.integrator != GrainIntegrator::semi_implicit_euler;
  for (const double share : {1e-3, 0.1, 1.0, 5.0}) {
    const double step = share * mass / dashpot;
    GrainSimulation simulation(scene, options_of(stepping, step));
    constexpr int steps = 5;
    simulation.advance(steps);
    // Verlet gives velocities as the mean of those half a step before and after
    const double middle = 0.5 * (1 + std::exp(-share));
    const double expected =
        speed * std::exp(-dashpot * steps * step / mass) * (verlet ? middle * middle * std::exp(share) : 1);
    CAPTURE(stepping.name(), share, separation_speed(simulation), expected);
    CHECK(separation_speed(simulation) == Approx(expected).epsilon(1e-12).margin(1e-15 * speed));
  }
}

TEST_CASE("explicit_dashpots_decay_with_an_error_of_first_order") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  const double dashpot = 2, speed = 1e-3, time = 0.5;
  const GrainScene scene = parting_pair(stepping.law, dashpot, speed);
  const double mass = 1 / (1 / scene.grains[0].inertia.mass + 1 / scene.grains[1].inertia.mass);
  const double expected = speed * std::exp(-dashpot * time / mass);
  std::vector<double> errors;
  for (const int steps : {16, 32, 64, 128, 256}) {
    GrainOptions options = options_of(stepping, time / steps);
    options.bond_step = GrainOptions::BondStep::explicit_euler;
    GrainSimulation simulation(scene, options);
    simulation.advance(steps);
    errors.push_back(std::abs(separation_speed(simulation) / expected - 1));
  }
  const double order = std::log2(errors.front() / errors.back()) / 4;
  CAPTURE(stepping.name(), errors, order);
  CHECK(order == Approx(1).margin(0.1));
}

TEST_CASE("a_pair_that_shears_stops_as_the_exponential_of_its_tangential_mass") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  const double c = 3, speed = 1e-7;  // so slow that the line of centres does not turn
  GrainScene scene = pair_scene(stepping.law, {.j = 1, .normal_dashpot = 1, .tangential_dashpot = c});
  scene.grains[0].velocity = {0, speed};
  scene.grains[1].spin = speed;
  const auto slip = [](const GrainSimulation& simulation) {
    const auto g = simulation.grains();
    return g[1].velocity.y - g[0].velocity.y - g[0].radius * g[0].spin - g[1].radius * g[1].spin;
  };
  const Grain &i = scene.grains[0], &j = scene.grains[1];
  const double inverse = bond_inverse_masses({{1, 0}, i.radius, j.radius}, {1 / i.inertia.mass, 1 / i.inertia.moment},
                                             {1 / j.inertia.mass, 1 / j.inertia.moment})
                             .tangential;
  const double time = 1.5 / (c * inverse);
  GrainSimulation simulation(scene, options_of(stepping, time / 100));
  const double before = slip(simulation);
  simulation.advance(100);
  CAPTURE(stepping.name(), before, slip(simulation));
  CHECK(slip(simulation) / before == Approx(std::exp(-1.5)).epsilon(2e-4));
}

TEST_CASE("bonds_by_eights_give_what_bonds_one_by_one_give") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  const auto bond_step = GENERATE(from_range(both_bond_steps));
  const double stiffest = GENERATE(1.0, 1e4);
  if (bond_step == GrainOptions::BondStep::explicit_euler && stiffest > 1) return;
  constexpr std::size_t pairs = 11;
  constexpr double step = 1e-3;
  Random random(7);
  GrainScene scene;
  for (std::size_t b = 0; b < pairs; ++b) {
    for (const double shift : {0.0, 0.9}) {
      Grain grain = ball({3.0 * static_cast<double>(b) + shift, 0.3 * shift}, random.uniform(0.3, 0.5),
                         {random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0.5, 2));
      grain.spin = random.uniform(-1, 1);
      scene.grains.push_back(grain);
    }
    const double strength = stiffest * std::exp(random.uniform(-4, 0)) / step;
    scene.bonds.push_back(
        {.i = 2 * b, .j = 2 * b + 1, .normal_dashpot = 0.2 * strength, .tangential_dashpot = 0.1 * strength});
    if (b % 3 == 0) scene.bonds.back().normal_spring = scene.bonds.back().tangential_spring = 20;
  }
  PairProperties contact = one_second(stepping.law, 0.5);
  contact.stiffness *= 100;
  contact.friction = 0.4;
  contact.tangential_ratio = 0.5;
  contact.tangential_damping = 0.1;
  scene.pairs = {contact};
  scene.walls = {line("floor", {0, -0.6}, {0, 1})};
  scene.gravity = {0, -5};
  GrainScene one_by_one = scene;  // a rolling dashpot that does nothing
  for (GrainBond& bond : one_by_one.bonds) bond.rolling_dashpot = 1e-300;
  GrainOptions options = options_of(stepping, step);
  options.bond_step = bond_step;
  GrainSimulation by_eights(scene, options), plain(one_by_one, options);
  by_eights.advance(400);
  plain.advance(400);
  const auto a = by_eights.grains(), b = plain.grains();
  for (std::size_t g = 0; g < a.size(); ++g) {
    CAPTURE(stepping.name(), stiffest, g, a[g].velocity.x, a[g].velocity.y, a[g].spin);
    CHECK(norm(a[g].position - b[g].position) < 1e-11);
    CHECK(norm(a[g].velocity - b[g].velocity) < 1e-10);
    CHECK(std::abs(a[g].spin - b[g].spin) < 1e-10);
  }
  const double lost = by_eights.energy().lost_bond;
  CAPTURE(lost, plain.energy().lost_bond, by_eights.counters().contacts);
  CHECK(by_eights.counters().contacts > 5);
  CHECK(lost > 1);
  CHECK(lost == Approx(plain.energy().lost_bond).epsilon(1e-11));
}

TEST_CASE("discs_of_a_pair_roll_on_one_another_freely") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  const auto bond_step = GENERATE(from_range(both_bond_steps));
  GrainBond bond{.j = 1, .normal_dashpot = 2, .tangential_dashpot = 2};
  GrainScene scene = pair_scene(stepping.law, bond);
  scene.grains[0].spin = 1 / scene.grains[0].radius;
  scene.grains[1].spin = -1 / scene.grains[1].radius;
  GrainOptions options = options_of(stepping, 0.002);
  options.bond_step = bond_step;
  GrainSimulation simulation(scene, options);
  simulation.advance(500);
  const auto grains = simulation.grains();
  const BondReport report = simulation.bonds();
  CAPTURE(stepping.name(), grains[0].spin, report.roll.largest, report.distance.largest, report.slip.largest);
  CHECK(grains[0].spin == Approx(scene.grains[0].spin).epsilon(1e-12));
  CHECK(grains[1].spin == Approx(scene.grains[1].spin).epsilon(1e-12));
  CHECK(report.roll.largest == Approx(scene.grains[0].spin - scene.grains[1].spin).epsilon(1e-12));
  CHECK(report.roll.mean == report.roll.largest);
  CHECK(report.distance.largest + report.slip.largest < 1e-12);

  // a rolling dashpot stops that of equal discs as exp(-2 C_r t/I)
  scene.grains[1] = scene.grains[0];
  scene.grains[1].position.x = 2 * scene.grains[0].radius;
  scene.grains[1].spin = -scene.grains[0].spin;
  scene.bonds[0].rolling_dashpot = 0.01;
  GrainSimulation braked(scene, options);
  braked.advance(500);
  const double share = std::exp(-2 * 0.01 * 1.0 / scene.grains[0].inertia.moment);
  CAPTURE(share, braked.grains()[0].spin);
  CHECK(braked.grains()[0].spin / scene.grains[0].spin == Approx(share).epsilon(2e-3));
}

TEST_CASE("a_pair_pressed_by_a_steady_force_creeps_at_force_over_dashpot") {
  // One on the floor, the other on top: its weight presses the bond, and nothing else does.
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  if (is_map(stepping.law)) return;  // a map that rests on a floor hops
  const double gravity = 1, step = 1e-3;
  for (const auto bond_step : both_bond_steps) {
    for (const double share : {0.05, 1.5, 100.0}) {
      if (bond_step == GrainOptions::BondStep::explicit_euler && share > 1.6) continue;
      GrainScene scene = pair_scene(stepping.law, {.j = 1});
      const double mass = 1 / (1 / scene.grains[0].inertia.mass + 1 / scene.grains[1].inertia.mass);
      const double dashpot = share * mass / step;
      scene.bonds[0].normal_dashpot = scene.bonds[0].tangential_dashpot = dashpot / 3;
      const double distance = scene.grains[1].position.x;
      scene.grains[1].position = {0, distance};
      scene.walls = {line("floor", {0, -scene.grains[0].radius}, {0, 1})};
      scene.gravity = {0, -gravity};
      scene.pairs[0].stiffness *= 400;
      scene.pairs[0].restitution = 0.2;
      GrainOptions options = options_of(stepping, step);
      options.bond_step = bond_step;
      GrainSimulation simulation(scene, options);
      simulation.advance(4000);  // the floor takes the weight
      const double before = simulation.bonds().distance.largest;
      simulation.advance(200);
      const double radii = scene.grains[0].radius + scene.grains[1].radius;
      const double rate = (simulation.bonds().distance.largest - before) * radii / (200 * step);
      const double expected = scene.grains[1].inertia.mass * gravity / (dashpot / 3);
      CAPTURE(stepping.name(), share, rate, expected, before);
      CHECK(rate == Approx(expected).epsilon(1e-6));
    }
  }
}

TEST_CASE("bonds_keep_momentum_and_angular_momentum") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  const auto bond_step = GENERATE(from_range(both_bond_steps));
  const GrainScene scene = chain_scene(stepping.law, 7, all_of_a_bond);
  GrainOptions options = options_of(stepping, 0.9 * bond_step_limit(scene, GrainOptions::BondStep::explicit_euler));
  options.bond_step = bond_step;
  GrainSimulation simulation(scene, options);
  const Momenta before = momenta_of(simulation.grains());
  simulation.advance(500);
  const Momenta after = momenta_of(simulation.grains());
  CAPTURE(stepping.name(), before.linear.x, before.linear.y, before.angular, after.angular - before.angular);
  CHECK(norm(after.linear - before.linear) < 1e-13);
  // the kicks act at places half a step from where they are counted; without them round-off
  CHECK(std::abs(after.angular - before.angular) < 1e-12);
}

TEST_CASE("bonded_discs_do_not_collide_with_each_other_but_with_all_others") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  GrainScene scene = pair_scene(stepping.law, {.j = 1, .normal_dashpot = 1, .tangential_dashpot = 1});
  scene.grains[1].position.x *= 0.9;  // pressed into one another
  GrainSimulation simulation(scene, options_of(stepping, 0.01));
  simulation.advance(50);
  CHECK(simulation.counters().contacts == 0);
  CHECK(simulation.bonds().distance.largest == 0);
  CHECK(simulation.grains()[1].position == scene.grains[1].position);

  scene.grains.push_back(ball({2, 0}, 0.3, {-1, 0}));
  GrainSimulation hit(scene, options_of(stepping, 0.01));
  hit.advance(300);
  CAPTURE(stepping.name(), hit.grains()[0].velocity.x);
  CHECK(hit.counters().contacts > 0);
  CHECK(hit.grains()[0].velocity.x < 0);  // what hit its partner moves it
}

TEST_CASE("springs_bring_a_bond_back_to_its_start") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  GrainScene scene = parting_pair(stepping.law, 2, 0.1);
  scene.bonds[0].normal_spring = scene.bonds[0].tangential_spring = 20;
  scene.grains[0].spin = 0.2;
  GrainSimulation simulation(scene, options_of(stepping, 0.005));
  simulation.advance(40);
  const BondReport stretched = simulation.bonds();
  simulation.advance(2000);
  const BondReport report = simulation.bonds();
  CAPTURE(stepping.name(), stretched.distance.largest, report.distance.largest, report.slip.largest);
  CHECK(stretched.distance.largest > 5e-3);
  CHECK(stretched.slip.largest > 1e-3);
  CHECK(report.distance.largest < 1e-4);  // what is left carries the turning pair
  CHECK(report.slip.largest < 1e-8);
}

TEST_CASE("bonds_of_a_scene_are_among_its_effects") {
  const GrainScene scene =
      pair_scene(NormalLaw::linear_dashpot, {.j = 1, .normal_dashpot = 1, .tangential_dashpot = 1});
  GrainScene free = scene;
  free.bonds.clear();
  const GrainOptions options = options_of(NormalLaw::linear_dashpot, 0.01);
  const GrainSimulation tied(scene, options), loose(free, options);
  CHECK(tied.effects().report().find("bonds") < tied.effects().report().find("inactive"));
  CHECK(loose.effects().report().find("bonds") > loose.effects().report().find("inactive"));
  CHECK(tied.effects().rotation);
  CHECK_FALSE(loose.effects().rotation);
  CHECK(tied.bonds().number == 1);
  CHECK(loose.bonds().number == 0);
  CHECK(loose.bytes_per_body() < tied.bytes_per_body());
}
