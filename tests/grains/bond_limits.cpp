// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How long a step bonds allow, what they lose, and what must not change a bit.
#include <limits>

#include "equidem/grains/contacts/bonds.hpp"

#include "grains/bonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

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
  GrainOptions options = options_of(law, 0.5 * explicit_step_limit(scene));
  GrainSimulation simulation(scene, options);
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
    GrainOptions options = options_of(stepping, step);
    GrainSimulation simulation(scene, options);
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
