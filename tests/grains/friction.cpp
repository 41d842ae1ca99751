// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Oblique impacts with Coulomb friction.
#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double degree = std::numbers::pi / 180;

/// Off a floor; the floor is horizontal, the radius 1 (of maps 1/4: their overlaps are small), contact begins within
/// the second step.
struct Shot {
  Vec2 velocity;
  double spin = 0, beta = 0.5, phase = 0.5;
};

GrainSimulation shoot(const Shot& shot, const PairProperties& pair, const GrainOptions& options) {
  Grain grain = ball({0, 1 - shot.velocity.y * options.time_step * (1 + shot.phase)}, 1, shot.velocity, 1, shot.beta);
  grain.spin = shot.spin;
  GrainSimulation simulation(scene_of({grain}, {line("floor", {0, 0}, {0, 1})}, pair), options);
  REQUIRE(pass_contact(simulation, static_cast<std::int64_t>(40 + 40 / options.time_step)));
  return simulation;
}

}  // namespace

TEST_CASE("an_impact_that_slips_throughout_follows_the_closed_form") {
  // v_t' = v_t - mu (1 + e) v_n, w' = mu (1 + e) v_n/(beta R), where v_t/v_n >= mu (1 + e)(1 + 1/beta); below that the
  // contact point comes to rest: v_t' = v_t/(1 + beta).
  const Stepping stepping = GENERATE(from_range(all_steppings));
  const double beta = GENERATE(0.4, 0.5);
  const double mu = GENERATE(0.02, 0.3);
  double largest = 0;
  int slipping = 0;
  for (int angle = 5; angle <= 85; angle += 5) {
    for (const double spring : {gives_force(stepping.law) ? 2e7 : 0.0, 1e7}) {
      for (const double e : {0.6, 1.0}) {
        PairProperties pair = one_second(stepping.law, e);
        pair.friction = mu;
        pair.tangential_ratio = spring;
        const Vec2 in{std::sin(angle * degree), -std::cos(angle * degree)};
        const GrainSimulation simulation = shoot({in, 0, beta, 0.5}, pair, options_of(stepping, 0.02));
        const Grain out = simulation.grains()[0];
        // of the force laws by the restitution that came out: it is right to their order only
        const bool exact = is_map(stepping.law) || stepping.law == NormalLaw::exact_flow;
        const double impulse = mu * (exact ? -(1 + e) * in.y : out.velocity.y - in.y);
        CAPTURE(stepping.name(), beta, mu, angle, spring, e, out.velocity.x, out.spin);
        if (in.x >= impulse * (1 + 1 / beta)) {
          ++slipping;
          CHECK(std::abs(out.velocity.x - (in.x - impulse)) < 1e-6);
          CHECK(std::abs(out.spin + impulse / beta) < 1e-6);  // clockwise
          largest = std::max(largest, std::abs(out.velocity.x - (in.x - impulse)));
        } else if (spring == 0) {
          CHECK(std::abs(out.velocity.x - in.x / (1 + beta)) < 1e-12);
        }
        // what friction does to the velocity it does to the spin
        CHECK(std::abs((in.x - out.velocity.x) + beta * out.spin) < 1e-13);
      }
    }
  }
  CAPTURE(stepping.name(), largest, slipping);
  CHECK(slipping > 15);
}

namespace {

/// The largest gain of energy of random impacts with the step a fraction of their duration of one second, in units of
/// the initial.
double largest_gain(Stepping stepping, double step, int count, ContactEnd end) {
  Random random(7);
  double largest = -1;
  for (int k = 0; k < count; ++k) {
    const double angle = random.uniform(0, 88) * degree;
    const double speed = std::pow(10.0, random.uniform(-2, 0));
    Shot shot;
    shot.velocity = {speed * std::sin(angle), -speed * std::cos(angle)};
    shot.spin = random.uniform(-2, 2) * speed;
    shot.beta = random.uniform(0.2, 1);
    shot.phase = random.uniform();
    PairProperties pair = one_second(stepping.law, k % 4 == 0 ? 1 : random.uniform(0.5, 1));
    if (stepping.law == NormalLaw::hertz_dashpot) pair.stiffness /= std::sqrt(-shot.velocity.y);
    pair.end = end;
    pair.friction = k % 5 == 0 ? 10 : random.uniform(0, 1);
    pair.tangential_ratio = k % 7 > 0 ? random.uniform(0, 1.5) : gives_force(stepping.law) ? 0.5 : 0;
    // the spring of Hertz as its largest overlap has it, N/m^(3/2) -> N/m
    if (stepping.law == NormalLaw::hertz_dashpot) pair.tangential_ratio *= std::sqrt(-0.34 * shot.velocity.y);
    pair.tangential_damping = pair.tangential_ratio > 0 && k % 3 == 0 ? random.uniform(0, 1) : 0;
    const GrainSimulation simulation = shoot(shot, pair, options_of(stepping, step));
    const EnergyLedger ledger = simulation.energy();
    largest = std::max(largest, ledger.kinetic / ledger.initial - 1);
  }
  return largest;
}

}  // namespace

TEST_CASE("no_oblique_impact_gains_energy") {
  // Maps and exact_flow: not by a digit. The force laws: by what their integrator errs, which falls with the step;
  // velocity_verlet, which gives contacts that begin or end within a step too much of it or too little, needs half the
  // step.
  const Stepping stepping = GENERATE(from_range(all_steppings));
  const ContactEnd end = GENERATE(ContactEnd::at_zero_force, ContactEnd::at_zero_overlap);
  const double step = stepping.integrator == GrainIntegrator::velocity_verlet ? 0.05 : 0.1;
  const double gain = largest_gain(stepping, step, 1000, end);
  const double finer = largest_gain(stepping, step / 2, 1000, end);
  const bool exact = is_map(stepping.law) || stepping.law == NormalLaw::exact_flow;
  CAPTURE(stepping.name(), to_string(end), gain, finer);
  CHECK(gain < (exact ? 1e-14 : 0.005));
  CHECK(finer < (exact ? 1e-14 : 0.001));
}

TEST_CASE("no_oblique_impact_of_two_grains_gains_energy") {
  // The normal turns during contact. Maps hold it over a step and lose by that; exact_flow follows it and may gain what
  // its order allows.
  const NormalLaw law = GENERATE(from_range(exact_laws));
  const auto gain = [&](double step) {
    Random random(3);
    double largest = -1;
    for (int k = 0; k < 1000; ++k) {
      const double angle = random.uniform(0, 85) * degree;
      PairProperties pair = one_second(law, k % 2 == 0 ? 1 : random.uniform(0.8, 1), 0.5);
      pair.friction = k % 4 == 0 ? 0 : random.uniform(0, 0.2);
      pair.tangential_ratio = random.uniform(0, 1);
      const Vec2 n{std::cos(angle), std::sin(angle)};
      Grain a = ball({0, 0}, 1, {0.5, 0});
      Grain b = ball((2 + random.uniform() * step) * n, 1, {-0.5, 0});
      a.spin = random.uniform(-1, 1);
      GrainSimulation simulation(scene_of({a, b}, {}, pair), options_of(law, step));
      if (!pass_contact(simulation, static_cast<std::int64_t>(40 / step))) continue;
      largest = std::max(largest, simulation.energy().kinetic / simulation.energy().initial - 1);
    }
    return largest;
  };
  const double coarse = gain(0.1), middle = gain(0.05), fine = gain(0.025);
  CAPTURE(to_string(law), coarse, middle, fine);
  if (law == NormalLaw::exact_flow) {
    CHECK(coarse < 1e-7);
    CHECK(middle < coarse / 8);
    CHECK(fine < middle / 8);
  } else {
    CHECK(coarse < 1e-14);
    CHECK(middle < 1e-14);
    CHECK(fine < 1e-14);
  }
}

TEST_CASE("a_disc_that_slides_comes_to_roll") {
  // F12: on a floor that carries its weight, u = u0/(1 + beta), at t = u0 beta/((1 + beta) mu g).
  const Stepping stepping = GENERATE(from_range(all_steppings));
  const double beta = GENERATE(0.4, 0.5);
  PairProperties pair{.friction = 0.4};
  if (gives_force(stepping.law)) return;  // these stick by a spring, which swings
  pair.restitution = 0.5;
  pair.stiffness = stepping.law == NormalLaw::hertz_dashpot ? 1e6 : 1e4;
  const double sunk = stepping.law == NormalLaw::hertz_dashpot ? std::pow(1 / 1e6, 2.0 / 3) : 1e-4;
  Grain grain = ball({0, 1 - sunk}, 1, {1.4, 0}, 1, beta);
  GrainSimulation simulation(scene_of({grain}, {line("floor", {0, 0}, {0, 1})}, pair, {0, -1}),
                             options_of(stepping, 1e-3));
  simulation.advance(400);
  const Grain sliding = simulation.grains()[0];
  simulation.advance(2600);
  const Grain rolling = simulation.grains()[0];
  CAPTURE(stepping.name(), beta, sliding.velocity.x, rolling.velocity.x, rolling.spin);
  // what keeps its grip holds to the last digits; the maps bounce a little
  const bool bounces = is_map(stepping.law);
  CHECK(std::abs(sliding.velocity.x - (1.4 - 0.4 * 0.4)) < (bounces ? 1e-6 : 1e-12));
  CHECK(std::abs(rolling.velocity.x - 1.4 / (1 + beta)) < 1e-12);
  CHECK(std::abs(rolling.velocity.x + rolling.spin) < 1e-12);
}

TEST_CASE("a_contact_that_sticks_under_a_steady_load_does_not_creep") {
  // in a groove, pushed askew: friction holds the disc, both contacts carry a steady tangential force
  const NormalLaw law = GENERATE(NormalLaw::linear_dashpot, NormalLaw::hertz_dashpot, NormalLaw::exact_flow);
  const double root = std::sqrt(0.5);
  GrainScene scene;
  scene.grains = {ball({0, std::sqrt(2.0)}, 1)};
  scene.walls = {line("left", {}, {root, root}), line("right", {}, {-root, root})};
  scene.gravity = {2, -9.8};
  PairProperties pair{.stiffness = 1e6,
                      .restitution = 0.3,
                      .end = ContactEnd::at_zero_overlap,
                      .friction = 0.8,
                      .tangential_ratio = 0.5,
                      .tangential_damping = 0.3};
  scene.pairs = {pair};
  GrainSimulation simulation(scene, options_of(law, 1e-4));
  simulation.advance(40000);
  const Grain rest = simulation.grains().front();
  double tangential = 0;
  for (const GrainContact& contact : simulation.contacts()) tangential += std::abs(contact.tangential_force);
  CAPTURE(to_string(law), norm(rest.velocity), rest.spin, tangential);
  CHECK(tangential > 0.01);
  CHECK(norm(rest.velocity) + std::abs(rest.spin) < 1e-12);
}

TEST_CASE("what_sticks_stretches_its_springs_by_the_way_of_the_bodies_however_long_the_step") {
  // A disc that a piston drives slowly into a corner: its normal forces grow all the time and pull askew at the springs
  // of the others. Between plane walls the stretch is linear in the way of the disc, exactly.
  const double phase = GENERATE(0.1, 0.5, 1.0);
  const double degrees = GENERATE(200.0, 260.0);
  GrainScene scene;
  scene.grains = {ball({1, 1}, 1)};
  const Vec2 inwards{-0.5, -std::sqrt(0.75)};
  scene.walls = {line("floor", {}, {0, 1}), line("left", {}, {1, 0}), line("piston", Vec2{1, 1} - inwards, inwards)};
  const Vec2 way{1e-4 * std::cos(degrees * degree), 1e-4 * std::sin(degrees * degree)};
  constexpr double duration = 2000;
  scene.walls[2].move_x = {Schedule::Kind::ramp, way.x, 0, duration};
  scene.walls[2].move_y = {Schedule::Kind::ramp, way.y, 0, duration};
  PairProperties pair{
      .stiffness = 1, .restitution = 0.2, .friction = 100, .tangential_ratio = 0.5, .tangential_damping = 0.2};
  scene.pairs = {pair};
  GrainSimulation simulation(scene, options_of(NormalLaw::exact_flow, phase));
  simulation.advance(static_cast<std::int64_t>(1.2 * duration / phase));
  const Grain disc = simulation.grains().front();
  const Vec2 went = disc.position - Vec2{1, 1};
  const EnergyLedger ledger = simulation.energy();
  CHECK(simulation.contacts().size() == 3);
  for (const GrainContact& contact : simulation.contacts()) {
    const Vec2 relative = (contact.j == ~2 ? way : Vec2{}) - went;
    const double stretch = dot(relative, perpendicular(contact.normal)) - disc.angle;
    CAPTURE(phase, degrees, contact.j, stretch, contact.tangential_force, contact.normal_force, ledger.lost_slip);
    CHECK(std::abs(stretch) > 1e-6);
    CHECK(std::abs(contact.tangential_force / (-0.5 * stretch) - 1) < 1e-9);
  }
  CAPTURE(phase, degrees, ledger.error(), ledger.work_of_walls, norm(disc.velocity));
  CHECK(std::abs(ledger.error()) < 1e-6 * ledger.work_of_walls);
}
