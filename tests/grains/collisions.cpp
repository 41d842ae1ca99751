// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One impact after another: each law gives back the restitution that it was asked for.
#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Rebound {
  double restitution = 0;  // measured
  double spin = 0, momentum = 0;
  EnergyLedger ledger;
  std::int64_t steps = 0;  // of evaluations of the law
};

/// On a wall (mass 1), or of two discs of unequal masses; closing speed 1, contact begins `phase` of a step after the
/// first step.
struct Impact {
  const char* name;
  bool wall;
  double mass_i, mass_j;
  [[nodiscard]] double reduced_mass() const { return wall ? mass_i : mass_i * mass_j / (mass_i + mass_j); }
};
constexpr Impact on_wall{"on a wall", true, 1, 0};
constexpr Impact of_two{"of two discs", false, 1, 7.3};

Rebound rebound(const Impact& impact, const GrainOptions& options, const PairProperties& pair, double phase) {
  const double radius = is_map(options.law) ? 0.25 : 10;  // the map's steps are short
  const double gap = (1 + phase) * options.time_step;
  const Vec2 along{0.6, 0.8};
  std::vector<Grain> grains;
  std::vector<Wall> walls;
  if (impact.wall) {
    grains.push_back(ball((radius + gap) * along, radius, -along, impact.mass_i));
    walls.push_back(line("wall", {0, 0}, along));
  } else {
    grains.push_back(ball({0, 0}, radius, 0.3 * along, impact.mass_i));
    grains.push_back(ball((2 * radius + gap) * along, radius, -0.7 * along, impact.mass_j));
  }
  GrainSimulation simulation(scene_of(grains, walls, pair), options);
  REQUIRE(pass_contact(simulation, static_cast<std::int64_t>(20 + 20 / options.time_step)));
  const std::vector<Grain> after = simulation.grains();
  Rebound result;
  result.restitution = impact.wall ? dot(after[0].velocity, along) : dot(after[1].velocity - after[0].velocity, along);
  result.spin = after[0].spin;
  if (!impact.wall) {
    const Vec2 before = impact.mass_i * grains[0].velocity + impact.mass_j * grains[1].velocity;
    result.momentum = norm(impact.mass_i * after[0].velocity + impact.mass_j * after[1].velocity - before);
  }
  result.ledger = simulation.energy();
  result.steps = simulation.counters().evaluations;
  return result;
}

std::vector<Impact> impacts() {
  return {on_wall, of_two};
}

/// The largest error of e over phases, at n steps in a contact of one second.
double largest_error(Stepping stepping, ContactEnd end, int n) {
  double largest = 0;
  for (int p = 0; p < 16; ++p) {
    PairProperties pair = one_second(stepping.law, 0.7);
    pair.end = end;
    const Rebound result = rebound(on_wall, options_of(stepping, 1.0 / n), pair, (p + 0.5) / 16);
    largest = std::max(largest, std::abs(result.restitution - 0.7));
  }
  return largest;
}

}  // namespace

TEST_CASE("the_maps_lose_1_minus_e_squared_at_any_phase_of_contact") {
  double largest = 0;
  for (const NormalLaw law : {NormalLaw::five_case_map, NormalLaw::energy_map}) {
    for (const Impact& impact : impacts()) {
      for (const double e : {0.0, 0.3, 0.7, 0.95, 1.0}) {
        for (const double a : {0.01, 0.1, 0.9, 1.0, 4.0}) {
          if (law == NormalLaw::five_case_map && e * e < a / (1 + a)) continue;
          for (int p = 0; p <= 40; ++p) {
            PairProperties pair{.dimensionless = a, .restitution = e};
            const Rebound result = rebound(impact, options_of(law, 0.1), pair, p / 40.0);
            const double in = 0.5 * impact.reduced_mass();
            CAPTURE(to_string(law), impact.name, e, a, p, result.steps, result.restitution,
                    result.ledger.lost_restitution / in);
            CHECK(std::abs(result.restitution * result.restitution - e * e) < 1e-14);
            CHECK(std::abs(result.ledger.lost_restitution / in - (1 - e * e)) < 1e-13);
            CHECK(std::abs(result.ledger.error()) < 1e-14 * result.ledger.initial);
            CHECK(result.momentum < 1e-14);
            largest = std::max(largest, std::abs(result.restitution * result.restitution - e * e));
          }
        }
      }
    }
  }
}

TEST_CASE("exact_flow_gives_its_restitution_at_any_phase_and_with_any_step") {
  double largest = 0;
  for (const ContactEnd end : {ContactEnd::at_zero_force, ContactEnd::at_zero_overlap}) {
    for (const Impact& impact : impacts()) {
      for (const double e : {0.02, 0.3, 0.7, 0.95, 1.0}) {
        for (const double step : {0.01, 0.03, 0.1, 0.33, 0.5, 1.0, 1.7, 3.0}) {
          for (int p = 0; p <= 8; ++p) {
            PairProperties pair = one_second(NormalLaw::exact_flow, e, impact.reduced_mass());
            pair.end = end;
            const Rebound result = rebound(impact, options_of(NormalLaw::exact_flow, step), pair, p / 8.0);
            CAPTURE(to_string(end), impact.name, e, step, p, result.steps, result.restitution);
            CHECK(std::abs(result.restitution - e) < 1e-12);
            CHECK(std::abs(result.ledger.error()) < 1e-13 * result.ledger.initial);
            CHECK(result.momentum < 1e-13);
            largest = std::max(largest, std::abs(result.restitution - e));
          }
        }
      }
    }
  }
}

TEST_CASE("restitution_of_the_force_laws_converges_with_the_step") {
  // First order: the dashpot is evaluated at the start of a step, and contacts begin and end between steps.
  // (velocity_verlet with the velocities of the half step is the same leapfrog as semi_implicit_euler, seen half a step
  // later.)
  for (const Stepping& stepping : all_steppings) {
    if (is_map(stepping.law) || stepping.law == NormalLaw::exact_flow) continue;
    for (const ContactEnd end : {ContactEnd::at_zero_force, ContactEnd::at_zero_overlap}) {
      std::vector<double> errors;
      for (const int n : {25, 50, 100, 200, 400}) errors.push_back(largest_error(stepping, end, n));
      const double order = std::log2(errors.front() / errors.back()) / 4;
      CAPTURE(stepping.name(), to_string(end), errors, order);
      CHECK(errors.back() < 1e-3);
      CHECK(order > 0.9);
      CHECK(order < 1.3);
    }
  }
}

namespace {

/// Two equal discs that mirror each other between two walls, so that neither touches two things at once.
double energy_drift(NormalLaw law, std::int64_t impacts, std::int64_t* steps) {
  PairProperties pair{.dimensionless = law == NormalLaw::exact_flow ? 1.0 : 0.1};
  GrainOptions options = options_of(law, 0.2);
  options.margin = 1000;  // the lists last
  GrainSimulation simulation(scene_of({ball({-1.5, 0}, 1, {1, 0}), ball({1.5, 0}, 1, {-1, 0})},
                                      {line("left", {-3, 0}, {1, 0}), line("right", {3, 0}, {-1, 0})}, pair),
                             options);
  const double before = simulation.energy().kinetic;
  double worst = 0;
  while (simulation.counters().contacts < impacts) {
    simulation.advance(997);
    const EnergyLedger ledger = simulation.energy();
    worst = std::max(worst, std::abs((ledger.kinetic + ledger.elastic_normal) / before - 1));
  }
  *steps = simulation.step();
  return worst;
}

}  // namespace

TEST_CASE("elastic_impacts_keep_the_energy") {
  for (const NormalLaw law : exact_laws) {
    std::int64_t steps = 0;
    const double drift = energy_drift(law, 100000, &steps);
    CAPTURE(to_string(law), drift, steps);
    CHECK(drift < 1e-10);
  }
}

TEST_CASE("steps_that_could_feed_a_cluster_are_counted") {
  // a chain vibrates at up to sqrt(2) of a pair's frequency: its limit is w dt = pi/sqrt(2) = 2.22
  const double turn = GENERATE(0.5, 1.0, 2.0, 2.8);
  const int balls = GENERATE(2, 5);
  GrainScene scene;
  for (int k = 0; k < balls; ++k) {
    const double closer = 2 - 1e-3;
    scene.grains.push_back(ball({closer * k, 0}, 1, {}));
  }
  PairProperties pair{.dimensionless = turn * turn};
  scene.pairs = {pair};
  GrainSimulation simulation(scene, options_of(NormalLaw::exact_flow, 1e-3));
  simulation.advance(1);
  CAPTURE(turn, balls, simulation.counters().doubtful);
  CHECK((simulation.counters().doubtful > 0) == (balls > 2 && turn > 2.22));
}
