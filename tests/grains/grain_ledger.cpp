// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The energy ledger: every joule that leaves the motion is found in one of the losses.
#include <limits>

#include "equidem/core/text.hpp"

#include "grains/cell_scenes.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Balance {
  double error = 0;  // largest over the run, of the initial energy; with cohesion, of the largest of the energies
  EnergyLedger last;
  std::int64_t contacts = 0;
};

Balance run(const GrainScene& scene, const GrainOptions& options, double time) {
  GrainSimulation simulation(scene, options);
  Balance balance;
  const auto steps = static_cast<std::int64_t>(std::llround(time / options.time_step));
  for (std::int64_t k = 0; k < steps; ++k) {
    simulation.advance(1);
    const EnergyLedger ledger = simulation.energy();
    const double size = scene.pairs[0].cohesion > 0 ? ledger.largest() : ledger.initial;
    balance.error = std::max(balance.error, std::abs(ledger.error()) / size);
  }
  balance.last = simulation.energy();
  balance.contacts = simulation.counters().contacts;
  return balance;
}

/// All that can take energy from a contact.
PairProperties lossy(NormalLaw law) {
  PairProperties pair = one_second(law, 0.7);
  pair.friction = 0.1;
  pair.tangential_ratio = 2;
  pair.tangential_damping = 0.2;
  return pair;
}

/// A spinning disc meets a floor that moves.
GrainScene oblique_impact(NormalLaw law, Vec2 gravity, bool moving) {
  Grain grain = ball({0, 1.03}, 1, {0.8, -1});
  grain.spin = 0.5;
  Wall floor = line("floor", {0, 0}, {0, 1});
  if (moving) {
    floor.move_x = {Schedule::Kind::sine, 0.1, 0, 0, 0.3};
    floor.move_y = {Schedule::Kind::sine, -0.05, 0, 0, 0.8};
  }
  return scene_of({grain}, {floor}, lossy(law), gravity);
}

}  // namespace

TEST_CASE("the_ledger_of_one_contact_closes_to_round_off_with_maps_and_exact_flow") {
  const NormalLaw law = GENERATE(from_range(exact_laws));
  const double step = GENERATE(0.02, 0.1);
  for (const bool moving : {false, true}) {
    for (const ContactEnd end : {ContactEnd::at_zero_force, ContactEnd::at_zero_overlap}) {
      GrainScene scene = oblique_impact(law, {0, 0}, moving);
      scene.pairs[0].end = end;
      const Balance balance = run(scene, options_of(law, step), 3);
      const EnergyLedger& l = balance.last;
      CAPTURE(to_string(law), step, moving, to_string(end), balance.error, l.lost_restitution, l.lost_dashpot,
              l.lost_slip, l.lost_tangential_dashpot, l.lost_release, l.work_of_walls);
      CHECK(balance.error < 1e-14);
      CHECK(l.lost_slip + l.lost_tangential_dashpot > 0.005);
      CHECK((is_map(law) ? l.lost_restitution : l.lost_dashpot) > 0.1);
      CHECK((is_map(law) ? l.lost_dashpot : l.lost_restitution) == 0);
      CHECK(moving == (l.work_of_walls != 0));
    }
  }
}

namespace {

/// A scene whose ledger is followed over a time in steps that are halved.
struct Followed {
  std::string name;
  GrainScene scene;
  std::vector<double> steps;
  double time;
  double largest, last;  ///< bounds on the errors, and on that of the shortest steps
  double order;          ///< at least; 0: it has none
};

std::vector<Followed> followed_scenes(const Stepping& stepping) {
  // By Euler force laws are of first order: velocities stand half a step behind. The Verlet schemes are of second
  // order. Maps keep the balance of a contact, but not that of gravity acting within it, nor of several contacts of a
  // body. exact_flow keeps both; where normals turn within a step and contacts overlap in time it is of second order.
  const NormalLaw law = stepping.law;
  const bool exact = law == NormalLaw::exact_flow, euler = stepping.integrator == GrainIntegrator::semi_implicit_euler;
  const double any = std::numeric_limits<double>::infinity();
  std::vector<Followed> scenes;
  for (const Vec2 gravity : {Vec2{0, 0}, Vec2{0.1, -0.3}}) {
    const bool round_off = exact || (is_map(law) && gravity == Vec2{});
    scenes.push_back({fmt::format("one contact, gravity {}", gravity.y),
                      oblique_impact(law, gravity, true),
                      {0.02, 0.01, 0.005, 0.0025, 0.00125},
                      6,
                      round_off ? 1e-12 : 0.03,
                      round_off ? 1e-12 : any,
                      round_off ? -any
                      : euler   ? 0.9
                                : 1.9});
  }
  const std::vector<double> short_steps{0.008, 0.004, 0.002, 0.001};
  scenes.push_back({"many contacts", busy_box(law, 3, 3, 5), short_steps, 2, any, exact ? 1e-6 : 0.03,
                    is_map(law) ? -any
                    : exact     ? 1.6
                                : 0.8});
  if (!gives_force(law)) return scenes;
  scenes.push_back({"shapes", mixed_box(law, 3, 3, 61), {0.004, 0.002, 0.001, 0.0005}, 1.5, any, 0.03, 0.8});
  GrainScene shapes = with_effects(mixed_box(law, 4, 4, 12), 2);
  shapes.pairs[0].stiffness *= 4;
  const std::vector<double> fine{0.002, 0.001, 0.0005};
  const double order = std::log2(1 / 0.4) / 2;
  scenes.push_back({"rolling and cohesion", with_effects(busy_box(law, 4, 4, 11), 2), fine, 2, 0.05, any, order});
  scenes.push_back({"rolling and cohesion of shapes", shapes, fine, 2, 0.05, any, order});
  scenes.push_back({"in a cell", with_effects(busy_cell(law, 4, 4, 13), 2), fine, 2, 0.05, any, order});
  return scenes;
}

}  // namespace

TEST_CASE("the_ledger_closes_to_the_order_of_the_integrator") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  for (const Followed& followed : followed_scenes(stepping)) {
    std::vector<double> errors;
    EnergyLedger last;
    for (const double step : followed.steps) {
      const Balance balance = run(followed.scene, options_of(stepping, step), followed.time);
      errors.push_back(balance.error);
      last = balance.last;
    }
    const double order = std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
    CAPTURE(stepping.name(), followed.name, errors, order, last.lost_rolling, last.cohesion);
    CHECK(*std::ranges::max_element(errors) < followed.largest);
    CHECK(errors.back() < followed.last);
    if (followed.order > 0) CHECK(order > followed.order);
    const bool effects = followed.scene.pairs[0].cohesion > 0;
    CHECK((last.lost_rolling > 0) == effects);
    CHECK((last.cohesion < 0) == effects);
  }
}

TEST_CASE("losses_of_an_impact_belong_to_their_mechanisms") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  PairProperties pair = lossy(stepping.law);
  pair.restitution = 0.8;
  const bool exact = is_map(stepping.law) || stepping.law == NormalLaw::exact_flow;
  const double accuracy = exact ? 1e-12 : 0.02;
  Grain grain = ball({0, 1.03}, 1, {0.8, -1});

  GrainSimulation rough(scene_of({grain}, {line("floor", {0, 0}, {0, 1})}, pair), options_of(stepping, 0.01));
  REQUIRE(pass_contact(rough, 1000));
  pair.friction = 0;
  pair.tangential_damping = 0;
  GrainSimulation smooth(scene_of({grain}, {line("floor", {0, 0}, {0, 1})}, pair), options_of(stepping, 0.01));
  REQUIRE(pass_contact(smooth, 1000));

  const EnergyLedger l = rough.energy();
  const EnergyLedger s = smooth.energy();
  CAPTURE(stepping.name(), l.initial, l.kinetic, s.kinetic, l.lost_restitution, l.lost_dashpot, l.lost_slip,
          l.lost_tangential_dashpot, l.lost_release, s.lost_release);
  // without friction the normal motion loses (1 - e²)/2, whatever takes it
  CHECK(s.lost() == Approx(0.18).epsilon(accuracy));
  CHECK(s.lost_slip + s.lost_tangential_dashpot == 0);
  // friction does not change that: what else is lost, the tangential motion lacks
  CHECK(l.lost_restitution == s.lost_restitution);
  CHECK(l.lost_dashpot == s.lost_dashpot);
  const double tangential = l.lost_slip + l.lost_tangential_dashpot + l.lost_release - s.lost_release;
  CHECK(tangential == Approx(s.kinetic - l.kinetic).epsilon(2 * accuracy));
}

namespace {

/// Error of the ledger when a contact is over, of the initial energy: root mean square over the instants in a step at
/// which it begins.
double error_when_over(const GrainScene& scene, const Stepping& stepping, double step) {
  constexpr int phases = 10;
  double sum = 0;
  for (int k = 0; k < phases; ++k) {
    GrainScene shifted = scene;
    shifted.grains[0].position.y += step * k / phases;
    GrainSimulation simulation(shifted, options_of(stepping, step));
    REQUIRE(pass_contact(simulation, 100000));
    const EnergyLedger ledger = simulation.energy();
    sum += std::pow(ledger.error() / ledger.initial, 2);
  }
  return std::sqrt(sum / phases);
}

}  // namespace

TEST_CASE("friction_leaves_an_error_of_the_second_order_of_the_step") {
  // What sticks and slips in turns; without a tangential dashpot nothing hides what the spring stores between both.
  constexpr auto integrator = GrainIntegrator::velocity_verlet;
  const double dashpot = GENERATE(0.0, 0.2), friction = GENERATE(0.1, 0.5), ratio = GENERATE(0.5, 2.0);
  const bool wall = GENERATE(false, true);
  PairProperties pair = one_second(NormalLaw::linear_dashpot, 0.7, wall ? 1 : 0.5);
  pair.friction = friction;
  pair.tangential_ratio = ratio;
  pair.tangential_damping = dashpot;
  GrainScene scene = scene_of({ball({0.5, 1.03}, 1, {0.4, -1})}, {line("floor", {0, 0}, {0, 1})}, pair);
  if (!wall) scene = scene_of({ball({0.5, 2.03}, 1, {0.4, -1}), ball({0, 0}, 1)}, {}, pair);
  std::vector<double> errors;
  for (const double step : {0.02, 0.005, 0.00125}) {
    errors.push_back(error_when_over(scene, {NormalLaw::linear_dashpot, integrator}, step));
  }
  CAPTURE(dashpot, friction, ratio, wall, errors);
  CHECK(errors[0] < 8e-4);
  CHECK(errors[2] < errors[0] / 150);  // 256 for the second order, 16 for the first
}

TEST_CASE("a_wall_works_on_what_it_pushes") {
  // Seen from a wall that comes with speed 1 an impact with e = 1 turns the velocity round: from rest to 2.
  const Stepping stepping = GENERATE(from_range(all_steppings));
  Wall piston = line("piston", {-1.5, 0}, {1, 0});
  piston.move_x = {Schedule::Kind::table, 0, 0, 0, 0, {0, 100}, {0, 100}};
  GrainSimulation simulation(scene_of({ball({0, 0}, 1, {})}, {piston}, one_second(stepping.law, 1)),
                             options_of(stepping, 1e-3));
  REQUIRE(pass_contact(simulation, 100000));
  const EnergyLedger l = simulation.energy();
  CAPTURE(stepping.name(), l.kinetic, l.work_of_walls, l.initial);
  const bool exact = is_map(stepping.law) || stepping.law == NormalLaw::exact_flow;
  CHECK(l.kinetic == Approx(2).epsilon(exact ? 1e-13 : 1e-5));
  CHECK(l.work_of_walls == Approx(2).epsilon(exact ? 1e-13 : 1e-5));
}

TEST_CASE("steps_lose_nothing_at_tangential_dashpots_that_are_not_there") {
  // What Verlet steps of a spring that sticks take or give beside its energy is their error, not a loss; it falls with
  // the square of the step.
  for (const Stepping& stepping : all_steppings) {
    std::vector<double> errors;
    for (const double step : {2e-3, 1e-3}) {
      GrainScene scene = busy_box(stepping.law, 5, 5, 11);
      scene.pairs[0].tangential_damping = 0;
      const Balance balance = run(scene, options_of(stepping, step), 2);
      errors.push_back(balance.error);
      const double lost = balance.last.lost_tangential_dashpot;
      CAPTURE(stepping.name(), step, lost, balance.last.lost(), balance.contacts, balance.error);
      CHECK(balance.last.lost_slip > 0);
      CHECK(lost == 0);
      if (!is_map(stepping.law)) CHECK(balance.error < 0.02);
    }
    CAPTURE(stepping.name(), errors[0], errors[1]);
    CHECK(errors[1] < std::max(0.9 * errors[0], 1e-3));
  }
}
