// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs tied by dashpots (Sukegawa 2010, chapter 5) and springs: their laws, how long a step they allow, what they
/// lose.
#include "equidem/grains/contacts/bonds.hpp"

#include <limits>
#include <set>
#include <utility>

#include "equidem/contact/finite_bond.hpp"

#include "grains/bonded_scenes.hpp"
#include "support/bond_rates.hpp"
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

namespace {

/// Discs that move at random, each bonded at random to some of the others by springs and dashpots of any size.
GrainScene random_network(std::size_t discs, std::size_t bonds, double far, Random& random) {
  GrainScene scene;
  scene.pairs = {one_second(NormalLaw::linear_dashpot, 1)};
  const auto vector = [&](double size) { return Vec2{random.uniform(-size, size), random.uniform(-size, size)}; };
  for (std::size_t k = 0; k < discs; ++k) {
    Grain grain = ball({3.0 * static_cast<double>(k % 7), 3.0 * static_cast<double>(k / 7)}, random.uniform(0.1, 0.2),
                       vector(1), random.uniform(0.5, 2));
    grain.position += vector(far);
    grain.angle = random.uniform(-3, 3);
    grain.spin = random.uniform(-1, 1);
    scene.grains.push_back(grain);
  }
  std::set<std::pair<std::size_t, std::size_t>> tied;
  while (tied.size() < bonds) {
    const std::size_t i = random.below(discs), j = random.below(discs);
    if (i == j || !tied.insert(std::minmax(i, j)).second) continue;
    const auto either = [&](double size) { return random.below(4) == 0 ? 0.0 : random.uniform(0, size); };
    GrainBond bond{.i = i,
                   .j = j,
                   .normal_dashpot = random.uniform(0.1, 3),
                   .tangential_dashpot = either(3),
                   .rolling_dashpot = either(0.2),
                   .normal_spring = random.uniform(1, 20),
                   .tangential_spring = either(20),
                   .bending_spring = either(2)};
    // at rest where the bond is shorter or longer, and turned by up to several turns
    const double turn = random.uniform(-1, 1) * (far > 0 ? 3 : 1e-3);
    const Vec2 branch = random.uniform(0.7, 1.4) * (scene.grains[j].position - scene.grains[i].position);
    bond.rest = BondRest{
        {branch.x * std::cos(turn) - branch.y * std::sin(turn), branch.x * std::sin(turn) + branch.y * std::cos(turn)},
        scene.grains[i].angle + far * random.uniform(-9, 9),
        scene.grains[j].angle + far * random.uniform(-9, 9)};
    scene.bonds.push_back(bond);
  }
  return scene;
}

/// Impulses of a step on the discs, by the laws of springs and of dashpots that are taken at the start of the step.
std::vector<BodyImpulse> impulses_by_laws(const GrainScene& scene, double step) {
  std::vector<BodyImpulse> impulses(scene.grains.size());
  for (const GrainBond& bond : scene.bonds) {
    const Grain &i = scene.grains[bond.i], &j = scene.grains[bond.j];
    const Vec2 branch = j.position - i.position, way = branch - bond.rest->branch;
    const double share = i.radius / (i.radius + j.radius), rest = norm(bond.rest->branch);
    const FiniteBond springs{bond.rest->branch,
                             share * rest,
                             (1 - share) * rest,
                             {.kN = bond.normal_spring, .kT = bond.tangential_spring},
                             bond.bending_spring};
    const BondForces<double> force = bond_forces(
        springs, BondMotion<double>{way.x, way.y, i.angle - bond.rest->angle_i, j.angle - bond.rest->angle_j});
    const ContactFrame frame{branch / norm(branch), share * norm(branch), (1 - share) * norm(branch)};
    const BondModes rate = bond_rates(frame, {i.velocity, i.spin}, {j.velocity, j.spin});
    const double along = bond.normal_dashpot * rate.normal, across = bond.tangential_dashpot * rate.tangential;
    const double roll = bond.rolling_dashpot * rate.rolling;
    const Vec2 on_i = Vec2{force.x, force.y} + along * frame.normal + across * frame.tangent();
    impulses[bond.i].impulse += step * on_i;
    impulses[bond.j].impulse -= step * on_i;
    impulses[bond.i].torque += step * (force.moment_i + frame.lever_i * across + roll);
    impulses[bond.j].torque += step * (force.moment_j + frame.lever_j * across - roll);
  }
  return impulses;
}

}  // namespace

TEST_CASE("bonds_in_a_network_push_by_their_laws_however_far_they_are_turned") {
  Random random(5);
  const double far = GENERATE(0.0, 1.0);
  for (const std::size_t bonds : {1, 2, 9, 60, 240}) {
    GrainScene scene = random_network(40, bonds, far, random);
    const auto without = [&](double GrainBond::*one) {
      for (GrainBond& bond : scene.bonds) bond.*one = 0;
    };
    without(&GrainBond::rolling_dashpot), without(&GrainBond::normal_dashpot), without(&GrainBond::tangential_dashpot);
    for (int kind = 0; kind < 3; ++kind) {  // each kind has its own loop
      if (kind == 1) without(&GrainBond::bending_spring);
      if (kind == 2) without(&GrainBond::tangential_spring);
      const double step = 0.5 * bond_step_limit(scene, GrainOptions::BondStep::exact);
      GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, step));
      simulation.advance(1);
      const std::vector<BodyImpulse> expected = impulses_by_laws(scene, step);
      double largest = 0, off = 0;
      for (std::size_t g = 0; g < scene.grains.size(); ++g) {
        const Grain& before = scene.grains[g];
        const Grain after = simulation.grains()[g];
        const Vec2 impulse = before.inertia.mass * (after.velocity - before.velocity);
        const double torque = before.inertia.moment * (after.spin - before.spin);
        largest = std::max({largest, norm(expected[g].impulse), std::abs(expected[g].torque)});
        off = std::max({off, norm(impulse - expected[g].impulse), std::abs(torque - expected[g].torque)});
      }
      CAPTURE(far, bonds, kind, largest, off);
      CHECK(simulation.counters().contacts == 0);
      CHECK(off < 1e-13 * largest + 1e-15);  // velocities of 1 m/s are rounded
    }
  }
}

TEST_CASE("exact_dashpots_of_pairs_take_what_their_law_takes") {
  // Without other forces a rate decays by its own law alone; rolling of unequal discs by the spin that is left.
  const double step = 1e-2;
  for (const double stiffest : {1.0, 100.0, 1e4, 1e6}) {
    Random random(8);
    GrainScene scene;
    scene.pairs = {one_second(NormalLaw::linear_dashpot, 1)};
    for (std::size_t b = 0; b < 21; ++b) {
      for (const double shift : {0.0, 1.1}) {
        Grain grain = ball({4.0 * static_cast<double>(b) + shift, 0.4 * shift}, random.uniform(0.3, 0.5),
                           {random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0.5, 2));
        grain.spin = random.uniform(-1, 1);
        scene.grains.push_back(grain);
      }
      const double strength = stiffest * std::exp(random.uniform(-5, 0));
      scene.bonds.push_back(
          {.i = 2 * b, .j = 2 * b + 1, .normal_dashpot = strength, .tangential_dashpot = strength / 3});
    }
    const bool rolls = GENERATE(false, true);
    for (GrainBond& bond : scene.bonds) bond.rolling_dashpot = rolls ? 0.1 * bond.normal_dashpot : 0;
    GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, step));
    simulation.advance(1);
    double lost = 0;
    for (const GrainBond& bond : scene.bonds) {
      const Grain i = scene.grains[bond.i], j = scene.grains[bond.j];
      const Grain of_i = simulation.grains()[bond.i], of_j = simulation.grains()[bond.j];
      const Vec2 branch = j.position - i.position;
      const double share = i.radius / (i.radius + j.radius), distance = norm(branch);
      const ContactFrame frame{branch / distance, share * distance, (1 - share) * distance};
      const BondModes before = bond_rates(frame, {i.velocity, i.spin}, {j.velocity, j.spin});
      const BondModes after = bond_rates(frame, {of_i.velocity, of_i.spin}, {of_j.velocity, of_j.spin});
      const InverseInertia inverse_i{1 / i.inertia.mass, 1 / i.inertia.moment};
      const InverseInertia inverse_j{1 / j.inertia.mass, 1 / j.inertia.moment};
      const BondModes inverse = bond_inverse_masses(frame, inverse_i, inverse_j);
      CAPTURE(stiffest, rolls, bond.i, bond.normal_dashpot * inverse.normal * step);
      CHECK(after.normal ==
            Approx(before.normal * decay(bond.normal_dashpot * inverse.normal * step).keep).margin(1e-14));
      if (rolls) {
        const double along = (decay(bond.tangential_dashpot * inverse.tangential * step).keep - 1) * before.tangential /
                             inverse.tangential;
        const double turned =
            before.rolling + along * (frame.lever_i * inverse_i.moment - frame.lever_j * inverse_j.moment);
        CHECK(after.rolling ==
              Approx(turned * decay(bond.rolling_dashpot * inverse.rolling * step).keep).margin(1e-13));
      } else {
        CHECK(
            after.tangential ==
            Approx(before.tangential * decay(bond.tangential_dashpot * inverse.tangential * step).keep).margin(1e-14));
      }
      const auto kinetic = [](const Grain& g) {
        return 0.5 * g.inertia.mass * dot(g.velocity, g.velocity) + 0.5 * g.inertia.moment * g.spin * g.spin;
      };
      lost += kinetic(i) + kinetic(j) - kinetic(of_i) - kinetic(of_j);
    }
    CAPTURE(stiffest, rolls, lost);
    CHECK(simulation.energy().lost_bond == Approx(lost).epsilon(1e-12));
  }
}

TEST_CASE("discs_of_a_pair_roll_on_one_another_freely") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  GrainBond bond{.j = 1, .normal_dashpot = 2, .tangential_dashpot = 2};
  GrainScene scene = pair_scene(stepping.law, bond);
  scene.grains[0].spin = 1 / scene.grains[0].radius;
  scene.grains[1].spin = -1 / scene.grains[1].radius;
  const GrainOptions options = options_of(stepping, 0.002);
  GrainSimulation simulation(scene, options);
  simulation.advance(500);
  const auto grains = simulation.grains();
  const BondDrifts report = drifts_of(scene, simulation);
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
  for (const double share : {0.05, 1.5, 100.0}) {
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
    GrainSimulation simulation(scene, options_of(stepping, step));
    simulation.advance(4000);  // the floor takes the weight
    const double before = drifts_of(scene, simulation).distance.largest;
    simulation.advance(200);
    const double radii = scene.grains[0].radius + scene.grains[1].radius;
    const double rate = (drifts_of(scene, simulation).distance.largest - before) * radii / (200 * step);
    const double expected = scene.grains[1].inertia.mass * gravity / (dashpot / 3);
    CAPTURE(stepping.name(), share, rate, expected, before);
    CHECK(rate == Approx(expected).epsilon(1e-6));
  }
}

TEST_CASE("bonded_discs_do_not_collide_with_each_other_but_with_all_others") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  GrainScene scene = pair_scene(stepping.law, {.j = 1, .normal_dashpot = 1, .tangential_dashpot = 1});
  scene.grains[1].position.x *= 0.9;  // pressed into one another
  GrainSimulation simulation(scene, options_of(stepping, 0.01));
  simulation.advance(50);
  CHECK(simulation.counters().contacts == 0);
  CHECK(drifts_of(scene, simulation).distance.largest == 0);
  CHECK(simulation.grains()[1].position == scene.grains[1].position);

  scene.grains.push_back(ball({2, 0}, 0.3, {-1, 0}));
  GrainSimulation hit(scene, options_of(stepping, 0.01));
  hit.advance(300);
  CAPTURE(stepping.name(), hit.grains()[0].velocity.x);
  CHECK(hit.counters().contacts > 0);
  CHECK(hit.grains()[0].velocity.x < 0);  // what hit its partner moves it
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
  CHECK(loose.bytes_per_body() < tied.bytes_per_body());
}

namespace {

GrainBond dashpots_alone() {
  GrainBond bond = all_of_a_bond;
  bond.normal_spring = bond.tangential_spring = 0;
  return bond;
}

double energy_of(const GrainSimulation& simulation) {
  const EnergyLedger ledger = simulation.energy();
  return ledger.kinetic + ledger.elastic();
}

}  // namespace

TEST_CASE("just_below_the_limit_of_its_bonds_a_chain_is_stable_and_above_it_is_refused") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  const std::size_t discs = GENERATE(2, 3, 8);
  const bool springs = GENERATE(false, true);
  const GrainScene scene = chain_scene(stepping.law, discs, springs ? all_of_a_bond : dashpots_alone());
  const double limit = bond_step_limit(scene, GrainOptions::BondStep::exact);
  CAPTURE(stepping.name(), discs, springs, limit);
  if (!springs) {
    CHECK(limit == std::numeric_limits<double>::infinity());
    return;
  }
  GrainOptions options = options_of(stepping, 0.999 * limit);
  GrainScene slow = scene;  // the chain keeps its shape
  for (Grain& grain : slow.grains) grain.velocity *= 1e-6, grain.spin *= 1e-6;
  GrainSimulation simulation(slow, options);
  const double before = energy_of(simulation);
  simulation.advance(2000);
  CHECK(energy_of(simulation) < before);

  options.time_step = 1.001 * limit;
  CHECK_THROWS_WITH(GrainSimulation(scene, options),
                    Catch::Contains("1.001 times the limit of ") && Catch::Contains("that the bonds impose"));
}

TEST_CASE("the_limit_of_a_long_chain_of_equal_discs_is_sharp") {
  // straight: the highest mode of the normal dashpots alone is 4 C_n/m
  GrainScene scene;
  for (int k = 0; k < 40; ++k) scene.grains.push_back(ball({1.0 * k, 0}, 0.5));
  for (std::size_t k = 0; k + 1 < 40; ++k) scene.bonds.push_back({.i = k, .j = k + 1, .normal_dashpot = 3});
  CHECK(explicit_step_limit(scene) == Approx(2 / (4 * 3.0)));
  // and a pair has the limit of the thesis, 2 m/C_n with the reduced mass
  scene.bonds.resize(1);
  CHECK(explicit_step_limit(scene) == Approx(2 * 0.5 / 3.0));
}

TEST_CASE("exact_dashpots_never_feed_the_motion_however_long_the_step") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  const double strength = GENERATE(1.0, 1e3, 1e6, 1e12);
  GrainBond bond = dashpots_alone();
  for (double* dashpot : {&bond.normal_dashpot, &bond.tangential_dashpot, &bond.rolling_dashpot}) *dashpot *= strength;
  GrainScene scene = chain_scene(stepping.law, 9, bond);
  GrainSimulation simulation(scene, options_of(stepping, 0.01));
  double before = energy_of(simulation);
  for (int k = 0; k < 300; ++k) {
    simulation.advance(1);
    const double now = energy_of(simulation);
    CAPTURE(stepping.name(), strength, k, before, now);
    REQUIRE(now <= before * (1 + 1e-14));
    before = now;
  }
}

TEST_CASE("the_ledger_of_dashpots_closes_to_round_off_with_euler") {
  const NormalLaw law = GENERATE(NormalLaw::linear_dashpot, NormalLaw::energy_map);
  const GrainScene scene = chain_scene(law, 5, dashpots_alone());
  GrainSimulation simulation(scene, options_of(law, 0.5 * explicit_step_limit(scene)));
  simulation.advance(100);
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(to_string(law), ledger.kinetic, ledger.lost_bond, ledger.initial, ledger.error());
  CHECK(simulation.counters().contacts == 0);
  CHECK(std::abs(ledger.error()) < 1e-13 * ledger.initial);
  CHECK(ledger.lost() == ledger.lost_bond);
  CHECK(ledger.lost_bond > 0.3 * ledger.initial);
}

TEST_CASE("the_ledger_of_bonds_closes_with_the_step") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  const GrainScene scene = chain_scene(stepping.law, 4, all_of_a_bond);
  std::vector<double> errors;
  // of the Verlet schemes the next order is still a third of the error at 0.001 s, and of the other sign
  for (const double step : {0.001, 0.0005, 0.00025, 0.000125}) {
    GrainSimulation simulation(scene, options_of(stepping, step));
    simulation.advance(std::llround(1 / step));
    const EnergyLedger ledger = simulation.energy();
    errors.push_back(std::abs(ledger.error()) / ledger.initial);
  }
  const double order = std::log2(errors[2] / errors[3]);
  CAPTURE(stepping.name(), errors, order);
  CHECK(errors.back() < 0.01);
  CHECK(order > (stepping.integrator == GrainIntegrator::semi_implicit_euler ? 0.85 : 1.9));
}

TEST_CASE("bonds_that_make_no_sense_are_refused") {
  const NormalLaw law = NormalLaw::linear_dashpot;
  const GrainBond good{.j = 1, .normal_dashpot = 1, .tangential_dashpot = 1};
  const auto refused = [&](const auto& change, const std::string& said) {
    GrainScene scene = pair_scene(law, good);
    GrainOptions options = options_of(law, 0.01);
    change(scene, options);
    CHECK_THROWS_WITH(check(scene, options), Catch::Contains(said));
  };
  using Scene = GrainScene;
  using Options = GrainOptions;
  refused([](Scene& s, Options&) { s.bonds[0].j = 2; }, "a bond ties grain 2 (there are 2 grains, counted from 0)");
  refused([](Scene& s, Options&) { s.bonds[0].j = 0; }, "a bond ties grain 0 to itself");
  refused([](Scene& s, Options&) { s.bonds.push_back({.i = 1, .j = 0, .normal_dashpot = 2}); },
          "grains 0 and 1 are bonded twice");
  refused([](Scene& s, Options&) { s.bonds[0].rolling_dashpot = -1; },
          "the rolling_dashpot of the bond of grains 0 and 1 is -1");
  refused([](Scene& s, Options&) { s.bonds[0].normal_spring = std::numeric_limits<double>::quiet_NaN(); },
          "the normal_spring of the bond of grains 0 and 1 is nan");
  refused([](Scene& s, Options&) { s.bonds[0] = {.j = 1}; }, "it ties nothing");
  refused([](Scene& s, Options&) { s.grains[1].short_half_axis = 0.1; }, "a bond ties grain 1, which is no disc");
  refused([](Scene&, Options& o) { o.law = NormalLaw::exact_flow; }, "Use the law linear_dashpot");
  refused([](Scene& s, Options&) { s.grains[1].position = s.grains[0].position; }, "inside one another");
}

TEST_CASE("bonded_discs_that_are_pressed_into_one_another_stop_the_run") {
  GrainScene scene = pair_scene(NormalLaw::linear_dashpot, {.j = 1, .normal_dashpot = 0.5, .tangential_dashpot = 0.5});
  scene.grains[1].position = {0, 0.8};
  scene.walls = {line("floor", {0, -0.5}, {0, 1})};
  scene.gravity = {0, -1};
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 1e-3));
  CHECK_THROWS_WITH(simulation.advance(100000), Catch::Contains("the centres of the bonded grains 0 and 1"));
  CHECK(drifts_of(scene, simulation).distance.largest == Approx(1).epsilon(2e-3));
}
