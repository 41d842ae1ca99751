// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Impacts that are hard: several at once, unequal, soft, fast, many; and bodies that lie on one another: nothing may
/// creep, nothing may warm up.
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

std::string shown(double x) {
  return fmt::format("{:.1e}", x);
}

double momentum(const std::vector<Grain>& grains) {
  double sum = 0;
  for (const Grain& grain : grains) sum += grain.inertia.mass * grain.velocity.x;
  return sum;
}

/// The first of n balls in a row meets the others, which touch; contacts of w = sqrt(20), e = 1.
struct Cradle {
  std::vector<double> velocities;
  double energy = 0, momentum = 0;  // error, of the whole
};

Cradle swing(int n, NormalLaw law, double step) {
  std::vector<Grain> grains{ball({-2.5, 0}, 1, {1, 0})};
  for (int i = 1; i < n; ++i) grains.push_back(ball({2.0 * (i - 1), 0}, 1));
  GrainSimulation simulation(scene_of(grains, {}, {.stiffness = 10}), options_of(law, step));
  simulation.advance(static_cast<std::int64_t>(std::llround(30 / step)));
  CHECK(simulation.contacts().empty());
  Cradle cradle;
  for (const Grain& grain : simulation.grains()) cradle.velocities.push_back(grain.velocity.x);
  cradle.energy = simulation.energy().kinetic / 0.5 - 1;
  cradle.momentum = momentum(simulation.grains()) - 1;
  return cradle;
}

double distance(const Cradle& a, const Cradle& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.velocities.size(); ++k) {
    largest = std::max(largest, std::abs(a.velocities[k] - b.velocities[k]));
  }
  return largest;
}

}  // namespace

TEST_CASE("newtons_cradle_keeps_energy_and_momentum") {
  HardCase table({.name = "Newton's cradle",
                  .why = "a wave runs through balls that touch: each has two contacts at once, which end one by one. "
                         "Springs disperse it: the last ball does not take all, whatever the step"});
  for (const int n : {5, 10}) {
    const Cradle fine = swing(n, NormalLaw::exact_flow, 0.0125);
    std::vector<double> off, energy;
    for (const double step : {0.2, 0.1, 0.05}) {
      const Cradle cradle = swing(n, NormalLaw::exact_flow, step);
      off.push_back(distance(cradle, fine));
      energy.push_back(std::abs(cradle.energy));
      CAPTURE(n, step, cradle.velocities, cradle.energy, cradle.momentum);
      CHECK(std::abs(cradle.momentum) < 1e-13);
    }
    CAPTURE(n, fine.velocities, off, energy);
    // fourth order but for beginnings and ends of contacts, which fall anywhere in a step
    CHECK(off[0] < 1e-3);
    CHECK(off[2] < 2e-5);
    CHECK(energy[0] < 1e-4);
    CHECK(energy[2] < 1e-6);
    // what springs do is not what rigid balls are said to do
    CHECK(fine.velocities.back() > 0.85);
    CHECK(fine.velocities.back() < 0.95);
    CHECK(fine.velocities.front() < -0.1);
    table.note(fmt::format("{} balls, exact_flow, w dt = 0.22", n), "velocities 2e-5, energy 1e-6, momentum 1e-13",
               fmt::format("velocities {}, energy {}; first ball {:.4f}, last {:.4f}", shown(off[2]), shown(energy[2]),
                           fine.velocities.front(), fine.velocities.back()));
    const Cradle map = swing(n, NormalLaw::energy_map, 0.05);
    CHECK(std::abs(map.momentum) < 1e-13);
    CHECK(map.energy > 0.01);
    table.note(fmt::format("{} balls, energy_map, w dt = 0.22", n), "none: it keeps the energy of two bodies only",
               fmt::format("energy {:+.1e}", map.energy));
  }
}

TEST_CASE("a_mass_ratio_of_a_million_changes_nothing") {
  HardCase table({.name = "a mass ratio of 1e6",
                  .why = "the reduced mass is that of the light body alone; digits of the heavy one cancel"});
  double worst = 0;
  for (const NormalLaw law : exact_laws) {
    for (const double e : {0.7, 1.0}) {
      for (const bool heavy_moves : {true, false}) {
        PairProperties pair = one_second(law, e);
        GrainSimulation simulation(scene_of({ball({0, 0}, 10, {heavy_moves ? 1.0 : 0.0, 0}, 1e6),
                                             ball({12.3, 0}, 2, {heavy_moves ? 0.0 : -1.0, 0}, 1)},
                                            {}, pair),
                                   options_of(law, 0.1));
        REQUIRE(pass_contact(simulation, 1000));
        const std::vector<Grain> after = simulation.grains();
        const double off = std::abs(after[1].velocity.x - after[0].velocity.x - e);
        const double light = (1 + e) / (1 + 1e-6) - (heavy_moves ? 0 : 1);
        CAPTURE(to_string(law), e, heavy_moves, off, after[1].velocity.x);
        CHECK(off < 1e-12);
        CHECK(std::abs(after[1].velocity.x - light) < 1e-12);
        CHECK(std::abs(simulation.energy().error()) < 1e-12 * simulation.energy().initial);
        worst = std::max(worst, off);
      }
    }
  }
  table.note("impact, maps and exact_flow", "restitution to 1e-12", shown(worst));

  // a heavy disc falls on a light one on the floor: both springs carry it back up
  PairProperties pair = one_second(NormalLaw::exact_flow, 1);
  pair.stiffness = 1e8;  // w dt = 0.5 of the light disc
  GrainSimulation press(
      scene_of({ball({0, 1}, 1, {}, 1), ball({0, 3.1}, 1, {0, -1}, 1e6)}, {line("floor", {0, 0}, {0, 1})}, pair),
      options_of(NormalLaw::exact_flow, 5e-5));
  double error = 0;
  for (int k = 0; k < 150; ++k) {
    press.advance(100);
    error = std::max(error, std::abs(press.energy().error()) / press.energy().initial);
  }
  CAPTURE(error, press.counters().contacts, press.grains()[1].velocity.y);
  CHECK(press.contacts().empty());
  CHECK(press.grains()[1].velocity.y == Approx(1).epsilon(1e-5));
  CHECK(error < 1e-9);
  table.note("heavy on light on the floor, exact_flow, w dt = 0.5", "energy to 1e-9 over the impact", shown(error));
}

TEST_CASE("perfectly_plastic_and_perfectly_elastic_impacts_are_exact") {
  HardCase table({.name = "restitution 0 and 1", .why = "the ends of the range, where a damping ratio is 1 or 0"});
  for (const NormalLaw law : {NormalLaw::energy_map, NormalLaw::exact_flow}) {
    for (const double e : {0.0, 1.0}) {
      PairProperties pair = one_second(law, e, 0.75);
      pair.end = ContactEnd::at_zero_overlap;
      GrainSimulation simulation(scene_of({ball({0, 0}, 1, {1, 0}, 1), ball({2.01, 0}, 1, {0, 0}, 3)}, {}, pair),
                                 options_of(law, 0.1));
      simulation.advance(200);
      const std::vector<Grain> after = simulation.grains();
      const double parting = after[1].velocity.x - after[0].velocity.x;
      CAPTURE(to_string(law), e, parting, simulation.energy().error());
      CHECK(std::abs(parting - e) < 1e-14);
      CHECK(std::abs(momentum(after) - 1) < 1e-14);
      CHECK(std::abs(simulation.energy().error()) < 1e-14);
      table.note(fmt::format("{}, e = {}", to_string(law), e), "1e-14", shown(std::abs(parting - e)));
    }
  }
  const GrainScene scene = scene_of({ball({0, 0}, 1)}, {}, one_second(NormalLaw::exact_flow, 0));
  table.refused("exact_flow, e = 0, contacts that end at zero force",
                attempt([&] { GrainSimulation(scene, options_of(NormalLaw::exact_flow, 0.1)); }),
                {"infinite dashpot", "zero overlap"});
}

TEST_CASE("steps_that_close_a_radius_and_contacts_within_a_step_are_exact") {
  HardCase table({.name = "steps as long as a radius or a contact",
                  .why = "the first that is seen of a contact is a body half sunk, or its end"});
  for (const NormalLaw law : {NormalLaw::energy_map, NormalLaw::exact_flow}) {
    double worst = 0;
    int refused = 0, runs = 0;
    for (const double closing : {0.3, 0.6, 0.9, 0.99}) {  // radii per step
      for (int p = 0; p < 10; ++p) {
        PairProperties pair{.dimensionless = 2, .restitution = 0.7};
        GrainSimulation simulation(
            scene_of({ball({0, 1 + closing * p / 10.0}, 1, {0, -closing})}, {line("floor", {0, 0}, {0, 1})}, pair),
            options_of(law, 1));
        ++runs;
        try {
          REQUIRE(pass_contact(simulation, 100));
        } catch (const Error& error) {
          INFO(error.what());
          CHECK(error.kind() == ErrorKind::computation_failed);
          ++refused;
          continue;
        }
        const double off = std::abs(simulation.grains()[0].velocity.y / closing - 0.7);
        CAPTURE(to_string(law), closing, p, off);
        CHECK(off < 1e-13);
        worst = std::max(worst, off);
      }
    }
    CAPTURE(to_string(law), refused, runs);
    CHECK(refused < runs / 4);
    table.note(fmt::format("{}, closing up to 0.99 radii a step, a = 2", to_string(law)),
               "restitution to 1e-13, or refused", fmt::format("{}, {} of {} refused", shown(worst), refused, runs));
  }
  double worst = 0;
  for (const double ratio : {10.0, 100.0, 1000.0}) {  // step over contact
    for (int p = 0; p < 10; ++p) {
      PairProperties pair = one_second(NormalLaw::exact_flow, 0.7);
      pair.stiffness *= ratio * ratio;
      GrainSimulation simulation(
          scene_of({ball({0, 1 + 0.9 * p / 10.0}, 1, {0, -0.9})}, {line("floor", {0, 0}, {0, 1})}, pair),
          options_of(NormalLaw::exact_flow, 1));
      simulation.advance(3);
      CAPTURE(ratio, p, simulation.counters().contacts);
      CHECK(simulation.counters().contacts == 1);
      worst = std::max(worst, std::abs(simulation.grains()[0].velocity.y / 0.9 - 0.7));
    }
  }
  CAPTURE(worst);
  CHECK(worst < 1e-12);
  table.note("exact_flow, contacts of 1e-1 to 1e-3 of a step", "restitution to 1e-12", shown(worst));
}

namespace {

/// Discs of several sizes thrown about in a box, e = 1, no gravity.
GrainSimulation billiards(NormalLaw law, double step, std::uint64_t seed) {
  Random random(seed);
  std::vector<Grain> grains;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      grains.push_back(
          ball({i + 0.5, j + 0.5}, random.uniform(0.3, 0.45), {random.uniform(-1, 1), random.uniform(-1, 1)}));
    }
  }
  return {scene_of(grains,
                   {line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}), line("right", {3, 0}, {-1, 0}),
                    line("lid", {0, 3}, {0, -1})},
                   {.stiffness = 1000}),
          options_of(law, step)};
}

double largest_energy_error(GrainSimulation simulation, std::int64_t steps) {
  double largest = 0;
  for (std::int64_t k = 0; k < steps; k += 20) {
    simulation.advance(20);
    largest = std::max(largest, std::abs(simulation.energy().error()) / simulation.energy().initial);
  }
  return largest;
}

}  // namespace

TEST_CASE("billiards_in_a_box_keep_their_energy") {
  HardCase table({.name = "elastic billiards in a box",
                  .why = "thousands of impacts, oblique and several at once: any bias of one adds up"});
  std::vector<double> errors;
  for (const double step : {0.02, 0.01, 0.005}) {  // w dt = 0.9, 0.45, 0.22
    double worst = 0;
    for (const std::uint64_t seed : {1, 2, 3}) {
      const auto steps = static_cast<std::int64_t>(100 / step);
      worst = std::max(worst, largest_energy_error(billiards(NormalLaw::exact_flow, step, seed), steps));
    }
    errors.push_back(worst);
  }
  CAPTURE(errors);
  CHECK(errors[0] < 0.01);
  CHECK(errors[2] < errors[0] / 16);
  table.note("9 discs, 100 s, exact_flow, w dt = 0.9, 0.45, 0.22", "energy, second order or better",
             fmt::format("{}, {}, {}", shown(errors[0]), shown(errors[1]), shown(errors[2])));
  const double bounded = largest_energy_error(billiards(NormalLaw::exact_flow, 0.005, 1), 100000);
  CAPTURE(bounded);
  CHECK(bounded < 1e-3);
  table.note("1e5 steps, exact_flow, w dt = 0.22", "energy to 1e-3", shown(bounded));
}

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
  PairProperties pair{.stiffness = stiffness, .restitution = restitution};
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
