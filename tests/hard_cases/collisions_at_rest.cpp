// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that lie on one another: nothing may creep, nothing may warm up.
#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/core/text.hpp"

#include "grains/scenes.hpp"
#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Unrest {
  double creep = 0;  // largest way of a body, of the largest overlap
  double heat = 0;   // kinetic energy, of the elastic
  double error = 0;  // of the ledger, of the elastic energy
};

Unrest rest(GrainSimulation& simulation, std::int64_t steps) {
  const std::vector<Grain> before = simulation.grains();
  const EnergyLedger ledger = simulation.energy();
  Unrest unrest;
  for (int part = 0; part < 10; ++part) {
    simulation.advance(steps / 10);
    const EnergyLedger now = simulation.energy();
    double overlap = 0;
    for (const GrainContact& contact : simulation.contacts()) overlap = std::max(overlap, contact.overlap);
    const std::vector<Grain> grains = simulation.grains();
    for (std::size_t k = 0; k < grains.size(); ++k) {
      unrest.creep = std::max(unrest.creep, norm(grains[k].position - before[k].position) / overlap);
    }
    unrest.heat = std::max(unrest.heat, now.kinetic / now.elastic_normal);
    unrest.error = std::max(unrest.error, std::abs(now.error() - ledger.error()) / now.elastic_normal);
  }
  return unrest;
}

std::string shown(const Unrest& unrest) {
  return fmt::format("creep {:.1e}, heat {:.1e}", unrest.creep, unrest.heat);
}

/// Where each spring carries what lies above it: mass 1, radius 1, g = 1.
GrainScene column(int n, double stiffness, double restitution) {
  std::vector<Grain> grains;
  double height = 0;
  for (int i = 0; i < n; ++i) {
    height += (i == 0 ? 1 : 2) - (n - i) / stiffness;
    grains.push_back(ball({0, height}, 1));
  }
  PairProperties pair;
  pair.stiffness = stiffness;
  pair.restitution = restitution;
  return scene_of(std::move(grains), {line("floor", {0, 0}, {0, 1})}, pair, {0, -1});
}

const HardCase::Words tall_column{.name = "a column of 100 discs at rest",
                                  .why = "a hundred contacts that feel each other, and time for every bias to add up"};

void stand(HardCase& table, NormalLaw law, double restitution, double step, std::int64_t steps) {
  const double stiffness = 1e4;  // the lowest spring is pressed in by 1e-2
  GrainSimulation simulation(column(100, stiffness, restitution), options_of(law, step));
  const Unrest unrest = rest(simulation, steps);
  CAPTURE(to_string(law), restitution, step, steps, unrest.creep, unrest.heat, unrest.error);
  CHECK(unrest.creep < 1e-8);
  CHECK(unrest.heat < 1e-16);
  CHECK(unrest.error < 1e-9);
  table.note(fmt::format("{}, e = {}, w dt = {:.2f}, {} steps", to_string(law), restitution,
                         step * std::sqrt(2 * stiffness), steps),
             "creep 1e-8 of the overlap, heat below the floor, of the elastic energy", shown(unrest));
}

}  // namespace

TEST_CASE("a_column_of_100_discs_neither_creeps_nor_warms_up") {
  HardCase table(tall_column);
  stand(table, NormalLaw::exact_flow, 0.9, 0.001, 100000);
  stand(table, NormalLaw::exact_flow, 1.0, 0.01, 2000);
  stand(table, NormalLaw::linear_dashpot, 0.9, 0.001, 100000);
  stand(table, NormalLaw::linear_dashpot, 1.0, 0.003, 10000);

  // A map knows two bodies at a time: what lies on both sides of one makes it jump.
  GrainSimulation map(column(100, 1e4, 0.9), options_of(NormalLaw::energy_map, 0.001));
  const double elastic = map.energy().elastic_normal;
  map.advance(1000);
  const double heat = map.energy().kinetic / elastic;
  CAPTURE(heat);
  CHECK(heat > 1e-4);
  table.note("energy_map, e = 0.9, w dt = 0.14, 1000 steps", "none: made for two bodies",
             fmt::format("heat {:.1e}", heat));
}

TEST_CASE("a_column_stands_for_a_million_steps", "[.large]") {
  HardCase table(tall_column);
  stand(table, NormalLaw::exact_flow, 0.9, 0.001, 1000000);
  stand(table, NormalLaw::linear_dashpot, 0.9, 0.001, 1000000);
}

TEST_CASE("a_disc_wedged_between_two_walls_rests_and_rebounds") {
  HardCase table({.name = "a disc wedged between two walls",
                  .why = "two contacts of one body at once, neither along gravity; e of each is not e of both"});
  const double half = std::numbers::pi / 6;
  const std::vector<Wall> walls{line("left", {0, 0}, {std::cos(half), std::sin(half)}),
                                line("right", {0, 0}, {-std::cos(half), std::sin(half)})};
  for (const NormalLaw law : {NormalLaw::linear_dashpot, NormalLaw::hertz_dashpot, NormalLaw::exact_flow}) {
    PairProperties pair = one_second(law, 1);
    pair.stiffness *= 100;
    const double force = 1 / (2 * std::sin(half));
    const double overlap =
        law == NormalLaw::hertz_dashpot ? std::pow(force / pair.stiffness, 2.0 / 3) : force / pair.stiffness;
    GrainSimulation simulation(scene_of({ball({0, (1 - overlap) / std::sin(half)}, 1)}, walls, pair, {0, -1}),
                               options_of(law, 0.01));
    const Unrest unrest = rest(simulation, 10000);
    const std::vector<GrainContact> contacts = simulation.contacts();
    CAPTURE(to_string(law), unrest.creep, unrest.heat);
    REQUIRE(contacts.size() == 2);
    CHECK(contacts[0].normal_force == Approx(force).epsilon(1e-11));
    CHECK(contacts[1].normal_force == Approx(force).epsilon(1e-11));
    CHECK(unrest.creep < 1e-10);
    CHECK(unrest.heat < 1e-18);
    table.note("at rest, " + to_string(law), "forces to 1e-11, creep 1e-10", shown(unrest));
  }
  std::vector<double> errors;
  for (const double step : {0.02, 0.01, 0.005}) {  // w dt = 0.63, 0.31, 0.16
    PairProperties pair = one_second(NormalLaw::exact_flow, 1);
    pair.stiffness *= 100;
    GrainSimulation simulation(scene_of({ball({0.1, 3}, 1)}, walls, pair, {0, -1}),
                               options_of(NormalLaw::exact_flow, step));
    double worst = 0;
    for (int k = 0; k < 100 / step; ++k) {
      simulation.advance(1);
      worst = std::max(worst, std::abs(simulation.energy().error()));
    }
    errors.push_back(worst);
  }
  CAPTURE(errors);
  CHECK(errors[0] < 1e-5);
  CHECK(errors[2] < 1e-7);
  table.note("falling in, e = 1, 100 s, exact_flow, w dt = 0.63, 0.31, 0.16", "energy to 1e-5, 1e-7 at the last",
             fmt::format("{:.1e}, {:.1e}, {:.1e}", errors[0], errors[1], errors[2]));
}

TEST_CASE("a_heap_comes_to_rest_and_stays") {
  HardCase table({.name = "a heap of 50 discs at rest",
                  .why =
                      "a hexagonal heap has more contacts than it needs: some carry nothing, and open and close at a "
                      "whim"});
  std::vector<Grain> grains;
  const double root3 = std::sqrt(3.0);
  for (int row = 0; grains.size() < 50; ++row) {
    for (int i = 0; i < 10 - row % 2 && grains.size() < 50; ++i) {
      grains.push_back(ball({1 + 2.0 * i + row % 2, 1 + row * root3}, 1));
    }
  }
  GrainScene scene =
      scene_of(grains, {line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}), line("right", {20, 0}, {-1, 0})},
               {.stiffness = 1e4, .restitution = 0.3}, {0, -1});
  const NormalLaw law = GENERATE(NormalLaw::exact_flow, NormalLaw::linear_dashpot);
  GrainSimulation settling(scene, options_of(law, 0.002));
  settling.advance(20000);
  const EnergyLedger settled = settling.energy();
  scene.grains = settling.grains();
  scene.pairs[0].restitution = 1;
  GrainSimulation resting(scene, options_of(law, 0.002));
  const Unrest unrest = rest(resting, 10000);
  CAPTURE(to_string(law), settled.kinetic, settled.elastic_normal, settled.error(), unrest.creep, unrest.heat,
          unrest.error, resting.contacts().size());
  CHECK(settled.kinetic < 1e-20 * settled.elastic_normal);
  CHECK(unrest.creep < 1e-8);
  CHECK(unrest.heat < 1e-16);
  // all weight comes down
  double weight = 0;
  for (const GrainContact& contact : resting.contacts()) {
    if (contact.normal.y == -1 && contact.j < 0) weight += contact.normal_force;
  }
  CHECK(weight == Approx(50).epsilon(1e-9));
  table.note(to_string(law) + ", settled with e = 0.3, then 1e4 steps with e = 1",
             "creep 1e-8 of the overlap, heat below the floor, of the elastic energy", shown(unrest));
}
