// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds that carry moments and break.
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/waves/natural_frequencies.hpp"

#include "grains/bonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double never = 1e90;  // N/m
constexpr double bond_kN = 400, bond_kT = 150, bond_kM = 12;
/// Two equal discs of mass 1 that just touch, tied by springs of these strengths.
GrainScene breaking_pair(NormalLaw law, double tension, double shear, double friction = 0) {
  constexpr double r = 0.5;
  GrainScene scene = scene_of({ball({-r, 0}, r), ball({r, 0}, r)}, {}, one_second(law, 1));
  scene.bonds = {{.j = 1, .normal_spring = bond_kN, .tangential_spring = bond_kT, .bending_spring = bond_kM}};
  scene.strengths = ContactStrengths{{tension}, {shear}, friction};
  return scene;
}

/// Steps until a bond breaks.
std::vector<BondBreak> run_to_break(GrainSimulation& simulation, std::int64_t most_steps) {
  while (simulation.breaks().empty() && simulation.step() < most_steps) simulation.advance(1);
  return simulation.breaks();
}

}  // namespace

TEST_CASE("a_bond_breaks_by_tension_with_bending_or_by_shear_with_friction") {
  const SpringConstants k{bond_kN, bond_kT};
  const double width = std::sqrt(12 * bond_kM / bond_kN);
  const auto mode = [&](double N, double T, double M) { return break_of(k, bond_kM, {N, T}, M, 10, 6, 0.5); };
  CHECK(mode(10, 0, 0) == BreakMode::tension);
  CHECK_FALSE(mode(9.99, 0, 0));
  CHECK(mode(0, 0, -10.01 * width / 6) == BreakMode::bending);
  CHECK_FALSE(mode(0, 0, 9.99 * width / 6));
  CHECK(mode(6, 0, 4.01 * width / 6) == BreakMode::tension);
  CHECK(mode(4, 0, 6.01 * width / 6) == BreakMode::bending);
  CHECK(mode(-3, 0, 13.01 * width / 6) == BreakMode::bending);
  CHECK_FALSE(mode(-3, 0, 12.99 * width / 6));  // compression closes the outer fibre
  CHECK(mode(0, -6.01, 0) == BreakMode::shear);
  CHECK_FALSE(mode(-4, 7.99, 0));
  CHECK(mode(-4, 8.01, 0) == BreakMode::shear);
  CHECK_FALSE(break_of(k, bond_kM, {0, 0}, 0, 0, 0, 0.5));  // what carries nothing does not break
  CHECK(break_of(k, 0, {1e-300, 0}, 0, 0, 6, 0.5) == BreakMode::tension);
  CHECK(break_of(k, 0, {0, 1e-300}, 0, 6, 0, 0.5) == BreakMode::shear);
  CHECK_FALSE(break_of(k, 0, {-1, 0}, 0, 0, 6, 0.5));
}

TEST_CASE("a_pair_that_parts_breaks_at_its_strength_and_flies_on_with_the_rest_of_its_energy") {
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  const double speed = 0.2, strength = 2, omega = std::sqrt(2 * bond_kN);  // of the reduced mass 1/2
  GrainScene scene = breaking_pair(stepping.law, strength, never);
  scene.grains[0].velocity = {-speed / 2, 0};
  scene.grains[1].velocity = {speed / 2, 0};
  const double step = 1e-4 / omega, time = std::asin(strength * omega / (bond_kN * speed)) / omega;
  GrainSimulation simulation(scene, options_of(stepping, step));
  const std::vector<BondBreak> breaks = run_to_break(simulation, 40000);
  REQUIRE(breaks.size() == 1);
  const double energy = strength * strength / (2 * bond_kN);
  CAPTURE(stepping.name(), breaks[0].step * step, time, breaks[0].energy, energy);
  CHECK(breaks[0].mode == BreakMode::tension);
  CHECK(std::abs(static_cast<double>(breaks[0].step) * step - time) < 3 * step);
  CHECK(breaks[0].energy == Approx(energy).epsilon(1e-3));
  CHECK(norm(breaks[0].place) < 1e-12);
  simulation.advance(1000);
  const EnergyLedger ledger = simulation.energy();
  const double initial = 0.25 * speed * speed;
  CHECK(ledger.kinetic == Approx(initial - energy).epsilon(1e-3));
  CHECK(ledger.lost_breaking == Approx(energy).epsilon(1e-3));
  CHECK(std::abs(ledger.error()) < 2e-4 * initial);
  CHECK(ledger.elastic() == 0);
}

TEST_CASE("a_contact_beside_a_bond_shares_its_compression_and_none_of_its_tension") {
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  const double speed = 0.2, strength = 2, initial = 0.25 * speed * speed;  // of the reduced mass 1/2
  GrainScene scene = breaking_pair(stepping.law, strength, never);
  scene.strengths->beside_contact = true;
  scene.pairs[0].stiffness *= 40;
  scene.grains[0].velocity = {speed / 2, 0};
  scene.grains[1].velocity = {-speed / 2, 0};
  const auto stored = [&](double overlap) {
    return bond_kN * overlap * overlap / 2 + describe(stepping.law).energy(scene.pairs[0].stiffness, overlap);
  };
  double expected = 0, too_large = 1;
  for (int halvings = 0; halvings < 60; ++halvings) {
    const double middle = (expected + too_large) / 2;
    (stored(middle) < initial ? expected : too_large) = middle;
  }
  const double bond_alone = std::sqrt(2 * initial / bond_kN);
  GrainSimulation simulation(scene, options_of(stepping, 1e-4 / std::sqrt(2 * bond_kN)));
  double overlap = 0;
  while (simulation.breaks().empty() && simulation.step() < 60000) {
    simulation.advance(1);
    const std::vector<Grain> grains = simulation.grains();
    overlap = std::max(overlap, 1 - norm(grains[1].position - grains[0].position));
  }
  REQUIRE(simulation.breaks().size() == 1);
  const double energy = strength * strength / (2 * bond_kN);
  CAPTURE(stepping.name(), overlap, expected, bond_alone, simulation.breaks()[0].energy, energy);
  CHECK(expected < 0.95 * bond_alone);
  CHECK(overlap == Approx(expected).epsilon(1e-3));
  CHECK(simulation.breaks()[0].mode == BreakMode::tension);
  CHECK(simulation.breaks()[0].energy == Approx(energy).epsilon(1e-3));
  simulation.advance(1000);
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(ledger.kinetic, ledger.lost_breaking, ledger.error());
  CHECK(ledger.kinetic == Approx(initial - energy).epsilon(2e-3));
  CHECK(ledger.lost_breaking == Approx(energy).epsilon(1e-3));
  CHECK(std::abs(ledger.error()) < 1e-3 * initial);
}

TEST_CASE("opposite_spins_break_a_bond_in_bending_and_equal_ones_in_shear") {
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  const double spin = 0.3, width = std::sqrt(12 * bond_kM / bond_kN), step = 1e-5;
  for (const bool bends : {true, false}) {
    const double strength = 0.5;
    GrainScene scene =
        bends ? breaking_pair(stepping.law, strength, never) : breaking_pair(stepping.law, never, strength);
    scene.grains[0].spin = bends ? -spin : spin;
    scene.grains[1].spin = spin;
    GrainSimulation simulation(scene, options_of(stepping, step));
    const std::vector<BondBreak> breaks = run_to_break(simulation, 200000);
    REQUIRE(breaks.size() == 1);
    // At 6 |M|/w = f_t, or at |T| = f_s: no other spring has been stretched to first order.
    const double moment = strength * width / 6;
    const double energy = bends ? moment * moment / (2 * bond_kM) : strength * strength / (2 * bond_kT);
    CAPTURE(stepping.name(), bends, breaks[0].step, breaks[0].energy, energy);
    CHECK(breaks[0].mode == (bends ? BreakMode::bending : BreakMode::shear));
    CHECK(breaks[0].energy == Approx(energy).epsilon(2e-3));
    simulation.advance(100);
    const EnergyLedger ledger = simulation.energy();
    CHECK(std::abs(ledger.error()) < 1e-3 * ledger.initial);
  }
}

TEST_CASE("opposite_spins_of_an_unbreakable_bond_swing_with_its_bending_frequency") {
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  GrainScene scene = breaking_pair(stepping.law, never, never);
  scene.grains[0].spin = -1e-3;
  scene.grains[1].spin = 1e-3;
  const double moment = scene.grains[0].inertia.moment, omega = std::sqrt(2 * bond_kM / moment);
  const int steps = 20000;
  GrainSimulation simulation(scene, options_of(stepping, std::numbers::pi / omega / steps));
  simulation.advance(steps);
  CAPTURE(stepping.name(), simulation.grains()[1].spin, simulation.grains()[1].angle);
  CHECK(simulation.breaks().empty());
  CHECK(simulation.grains()[1].spin == Approx(-1e-3).epsilon(1e-6));
  CHECK(std::abs(simulation.grains()[1].angle) < 3e-4 * 1e-3 / omega);
}

TEST_CASE("discs_whose_bond_broke_under_compression_rebound_and_slide_with_friction") {
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  std::vector<double> errors;
  for (const double step : {4e-5, 1e-5}) {
    GrainScene scene = breaking_pair(stepping.law, never, 0.4);
    scene.pairs[0].friction = 0.3;
    scene.pairs[0].tangential_ratio = 0.5;
    scene.grains[0].velocity = {0.5, 0};
    scene.grains[1].velocity = {-0.5, 0};
    scene.grains[0].spin = scene.grains[1].spin = 0.3;
    GrainSimulation simulation(scene, options_of(stepping, step));
    REQUIRE(run_to_break(simulation, 100000).size() == 1);
    CHECK(simulation.breaks()[0].mode == BreakMode::shear);
    const double spin_at_break = simulation.grains()[0].spin;
    simulation.advance(2);
    REQUIRE(simulation.contacts().size() == 1);
    CHECK(simulation.contacts()[0].normal_force > 0);
    while (!simulation.contacts().empty()) simulation.advance(10);
    const EnergyLedger ledger = simulation.energy();
    CAPTURE(stepping.name(), step, ledger.lost_breaking, ledger.lost_slip, ledger.error() / ledger.initial,
            spin_at_break, simulation.grains()[0].spin);
    CHECK(simulation.grains()[0].spin < spin_at_break);
    CHECK(simulation.grains()[1].velocity.x > 0);
    CHECK(std::abs(ledger.error()) < 2e-3 * ledger.initial);
    errors.push_back(std::abs(ledger.error()));
  }
  CHECK(errors[1] < 0.5 * errors[0] + 1e-12);
}

TEST_CASE("the_energy_of_a_chain_that_breaks_and_collides_balances_to_the_error_of_the_step") {
  GrainBond like;
  like.normal_spring = 60;
  like.tangential_spring = 40;
  like.bending_spring = 1;
  const Stepping stepping{NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet};
  const bool beside = GENERATE(false, true);
  std::vector<double> errors;
  for (const double step : {1e-3, 2.5e-4}) {
    GrainScene scene = chain_scene(stepping.law, 20, like);
    scene.pairs[0].stiffness *= 5;
    scene.pairs[0].friction = 0.4;
    scene.pairs[0].tangential_ratio = 0.5;
    scene.strengths = bond_strengths(scene, {.tension = 3.0, .shear = 2.0, .weibull_modulus = 4.0});
    scene.strengths->beside_contact = beside;
    GrainSimulation simulation(scene, options_of(stepping, step));
    simulation.advance(static_cast<std::int64_t>(std::llround(2 / step)));
    const EnergyLedger ledger = simulation.energy();
    CAPTURE(stepping.name(), beside, step, simulation.breaks().size(), ledger.lost_breaking, ledger.error(),
            ledger.initial);
    CHECK(simulation.breaks().size() > 4);
    errors.push_back(std::abs(ledger.error()) / ledger.initial);
  }
  CAPTURE(errors);
  CHECK(errors[0] < 5e-3);
  CHECK(errors[1] < 0.6 * errors[0]);
}

TEST_CASE("what_a_break_takes_from_the_balance_is_of_the_second_order_of_a_verlet_step") {
  // Whatever the step, the bond breaks in it under the same pull, at an offset of the same phase.
  const Stepping stepping{NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet};
  for (const bool dashpots : {false, true}) {
    for (const bool sheared : {false, true}) {
      std::vector<double> errors;
      for (const double step : {1.6e-3, 4e-4, 1e-4}) {
        GrainScene scene = breaking_pair(stepping.law, sheared ? never : 1.0, sheared ? 0.4 : never);
        if (dashpots) {
          scene.bonds[0].normal_dashpot = 0.3;
          scene.bonds[0].tangential_dashpot = 0.2;
          scene.bonds[0].rolling_dashpot = 0.01;
        }
        scene.grains[0].velocity = {sheared ? 0.3 : -0.1, 0};
        scene.grains[1].velocity = {sheared ? -0.3 : 0.1, 0};
        scene.grains[0].spin = scene.grains[1].spin = 0.3;
        GrainSimulation simulation(scene, options_of(stepping, step));
        REQUIRE(run_to_break(simulation, 100000).size() == 1);
        simulation.advance(1);
        const EnergyLedger ledger = simulation.energy();
        errors.push_back(std::abs(ledger.error()) / ledger.initial);
      }
      CAPTURE(stepping.name(), dashpots, sheared, errors);
      CHECK(errors[0] < 1e-4);
      CHECK(errors[2] < errors[0] / 100);  // 256 for the second order, 16 for the first
    }
  }
}

TEST_CASE("slow_loading_breaks_the_bond_that_statics_names_at_its_load") {
  // A bonded block whose left and right discs are as heavy as plates, and part slowly.
  Assembly block =
      delaunay_assembly({.discs = 40, .disorder = 0.2, .seed = 6, .radii = {.smallest = 0.4, .largest = 0.6}});
  for (Contact& c : block.contacts) {
    const double share = block.radii[c.i] / (block.radii[c.i] + block.radii[c.j]);
    c.lever_i = share * norm(block.branch(c));
    c.lever_j = norm(block.branch(c)) - c.lever_i;
  }
  const SpringConstants k{bond_kN, bond_kT};
  const double pull = 1e-6;
  const ContactSprings springs = bending_springs(block, ContactSprings(k), {.bond_width = 1.0});
  const std::vector<Support> ends{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0},
                                  {.group = "right", .ux = pull, .uy = 0.0, .rotation = 0.0}};
  const Equilibrium state = solve_equilibrium(block, springs, ends, {});

  GrainScene scene = scene_of({}, {}, one_second(NormalLaw::linear_dashpot, 1));
  for (std::size_t d = 0; d < block.size(); ++d) scene.grains.push_back(ball(block.centres[d], block.radii[d]));
  for (const char* end : {"left", "right"})
    for (const std::int32_t d : block.groups.at(end).discs)
      scene.grains[static_cast<std::size_t>(d)].inertia = {1e9, 1e9};
  // Dashpots in proportion to the springs take no part in how a steady motion divides forces: under a speed V of the
  // right end u = u_s V t solves K u + lag K u' = 0 inside, u_s being the motion of statics, once the start has died
  // out.
  const double lag = 0.025;  // s
  for (std::size_t c = 0; c < block.contacts.size(); ++c) {
    const Contact& contact = block.contacts[c];
    scene.bonds.push_back({.i = static_cast<std::size_t>(contact.i),
                           .j = static_cast<std::size_t>(contact.j),
                           .normal_dashpot = lag * k.kN,
                           .tangential_dashpot = lag * k.kT,
                           .rolling_dashpot = lag * springs.bending(c),
                           .normal_spring = k.kN,
                           .tangential_spring = k.kT,
                           .bending_spring = springs.bending(c)});
  }
  // Strengths at which the first bond breaks at a strain of about 1e-6.
  const StrengthOptions how{.tension = 2e-4, .shear = 1.6e-4, .weibull_modulus = 6.0, .seed = 11};
  scene.strengths = bond_strengths(scene, how);
  double first = std::numeric_limits<double>::infinity(), second = first;
  std::size_t weakest = 0;
  for (std::size_t c = 0; c < block.contacts.size(); ++c) {
    const double kM = springs.bending(c), fibre = 6 * std::abs(state.bending_moments[c]) / std::sqrt(12 * kM / k.kN);
    const ContactForce& f = state.contact_forces[c];
    const double pulled = (f.normal + fibre) / scene.strengths->tension[c];
    const double sheared = std::abs(f.tangential) / scene.strengths->shear[c];
    const double load = 1 / std::max({pulled, sheared, 1e-300});
    if (load < first)
      second = first, first = load, weakest = c;
    else
      second = std::min(second, load);
  }
  const double speed = 2e-8;
  for (const std::int32_t d : block.groups.at("right").discs)
    scene.grains[static_cast<std::size_t>(d)].velocity = {speed, 0};
  const double step = 5e-3, expected = first * pull / speed;
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, step));
  while (simulation.breaks().empty() && simulation.time() < 2 * expected) simulation.advance(1);
  REQUIRE_FALSE(simulation.breaks().empty());
  const BondBreak found = simulation.breaks().front();
  // The sudden start swings the block: all discs lack at most the speed V, which bends a bond by at most 2 sqrt(n)
  // V/omega, omega being the lowest frequency; it dies out as exp(-omega^2 lag t/2). Finite motions change forces by
  // the strain, 1e-6. What is left is the step in which the strength is reached, and the one before which it is told.
  std::vector<Inertia> inertia;
  for (std::size_t d = 0; d < block.size(); ++d) inertia.push_back(ball(block.centres[d], block.radii[d]).inertia);
  const DegreesOfFreedom unknowns =
      number_unknowns(block, springs, derive_effects(springs, Rotation::from_scene), ends);
  const double omega2 = natural_frequencies(block, springs, unknowns, inertia, {.count = 1}).squared.at(0);
  const ContactForce& strongest = state.contact_forces[weakest];
  const double stretch_rate = std::max(std::abs(strongest.normal) / k.kN, std::abs(strongest.tangential) / k.kT) / pull;
  const double swing =
      2 * std::sqrt(static_cast<double>(block.size()) / omega2) / stretch_rate * std::exp(-omega2 * lag * expected / 2);
  const double time = static_cast<double>(found.step) * step, bound = 2 * step + 1e-6 * expected + swing;
  CAPTURE(first, second / first, expected, time - expected, bound, swing, omega2, weakest, found.bond,
          to_string(found.mode));
  CHECK(std::abs(time - expected) < bound);
  CHECK((second - first) * pull / speed > 2 * bound);  // no other bond is as near
  CHECK(found.bond == weakest);
}

TEST_CASE("discs_that_overlap_under_a_bond_part_with_the_energy_of_the_overlap_when_it_breaks") {
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  GrainScene scene = breaking_pair(stepping.law, 1e-9, never);
  const double overlap = 1e-3;
  scene.grains[0].position.x += overlap / 2;
  scene.grains[1].position.x -= overlap / 2;
  scene.grains[0].velocity.x = -1e-6;
  scene.grains[1].velocity.x = 1e-6;
  const double stored = describe(stepping.law).energy(scene.pairs[0].stiffness, overlap);
  GrainSimulation simulation(scene, options_of(stepping, 1e-3));
  simulation.advance(20000);
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(stepping.name(), stored, ledger.initial, ledger.lost_breaking, ledger.kinetic, ledger.error());
  CHECK(simulation.breaks().size() == 1);
  CHECK(simulation.contacts().empty());
  CHECK(-ledger.lost_breaking == Approx(stored).epsilon(1e-3));
  CHECK(ledger.kinetic == Approx(stored).epsilon(1e-2));
  CHECK(ledger.kinetic > 1e3 * ledger.initial);
}

TEST_CASE("bonds_that_break_leave_the_neighbour_lists_of_all_others_alone") {
  // A chain that is pulled apart at its bonds, one after the other, faster than its discs move by the margin.
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  GrainScene scene = scene_of({}, {}, one_second(stepping.law, 1, 0.5));
  for (std::size_t k = 0; k < 41; ++k) scene.grains.push_back(ball({1.0 * static_cast<double>(k), 0}, 0.5));
  for (std::size_t k = 0; k + 1 < scene.grains.size(); ++k) {
    scene.grains[k + 1].velocity.x = scene.grains[k].velocity.x + 0.01 + 1e-4 * static_cast<double>(k);
    scene.bonds.push_back({.i = k, .j = k + 1, .normal_spring = bond_kN, .tangential_spring = bond_kT});
  }
  scene.strengths = ContactStrengths{std::vector<double>(40, 0.05), std::vector<double>(40, never), 0};
  GrainOptions options = options_of(stepping, 1e-4);
  options.bodies_per_block = 8;
  GrainSimulation simulation(scene, options);
  simulation.advance(300);
  CAPTURE(stepping.name(), simulation.breaks().size(), simulation.breaks().front().step,
          simulation.breaks().back().step, simulation.counters().rebuilds);
  CHECK(simulation.breaks().size() > 20);
  CHECK(simulation.breaks().back().step > simulation.breaks().front().step + 5);
  CHECK(simulation.counters().rebuilds <= 2);
  CHECK(simulation.contacts().empty());
}

TEST_CASE("strengths_that_mean_nothing_are_refused") {
  const auto refuses = [](const GrainScene& scene, NormalLaw law = NormalLaw::linear_dashpot) {
    CHECK_THROWS_AS(GrainSimulation(scene, options_of(law, 1e-4)), Error);
  };
  refuses(breaking_pair(NormalLaw::energy_map, 1, 1), NormalLaw::energy_map);
  GrainScene scene = breaking_pair(NormalLaw::linear_dashpot, 1, 1);
  scene.strengths->tension.push_back(1);
  refuses(scene);
  scene = breaking_pair(NormalLaw::linear_dashpot, 1, 1);
  scene.bonds[0].normal_spring = 0;
  refuses(scene);
  scene = breaking_pair(NormalLaw::linear_dashpot, 1, 1);
  scene.bonds[0].bending_spring = -1;
  refuses(scene);
  CHECK_THROWS_AS(bond_strengths(scene, {.tension = 1.0}), Error);
}

TEST_CASE("bonds_without_strength_all_break_under_their_first_load") {
  GrainScene scene = chain_scene(NormalLaw::linear_dashpot, 9, {.normal_spring = 50, .tangential_spring = 20});
  scene.strengths = ContactStrengths{std::vector<double>(8, 0.0), std::vector<double>(8, 0.0), 0};
  GrainScene still = scene;
  for (Grain& grain : still.grains) grain.velocity = {}, grain.spin = 0;
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 1e-3)),
      at_rest(still, options_of(NormalLaw::linear_dashpot, 1e-3));
  simulation.advance(2000);
  CHECK(simulation.breaks().size() == 8);
  CHECK(simulation.breaks().back().step == 1);
  at_rest.advance(2000);
  CHECK(at_rest.breaks().empty());
}
