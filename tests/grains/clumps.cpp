// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Clumps of discs: mass, motion, contacts.
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("the_inertia_of_a_clump_is_that_of_the_area_it_covers") {
  // Two discs that touch: 2 (m r²/2 + m r²) in closed form.
  const Clump pair = centred_clump({{{4, 1}, 1}, {{6, 1}, 1}});
  const Inertia of_pair = inertia_of_clump(pair, 2);
  const double mass = 2 * std::numbers::pi;
  CHECK(norm(pair.discs[0].offset - Vec2{-1, 0}) < 1e-14);
  CHECK(of_pair.mass == Approx(2 * mass).epsilon(1e-14));
  CHECK(of_pair.moment == Approx(2 * 1.5 * mass).epsilon(1e-14));
  CHECK(radius_of(pair) == Approx(2).epsilon(1e-14));
}

TEST_CASE("a_disc_of_a_clump_within_another_is_refused") {
  const Clump::Disc inner = GENERATE(Clump::Disc{{0.1, 0.1}, 0.2}, Clump::Disc{{0, 0}, 1});
  CHECK_THROWS_WITH(centred_clump({{{0, 0}, 1}, {{1.5, 0}, 1}, inner}), Catch::Contains("lies within disc"));
}

TEST_CASE("a_clump_of_one_disc_moves_as_the_disc") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const bool overlap = GENERATE(false, true);  // at the start
  GrainScene discs = busy_box(stepping.law, 3, 3, 41);
  for (Grain& grain : discs.grains) grain.radius *= overlap ? 1.25 : 1;
  GrainScene clumps = discs;
  for (Grain& grain : clumps.grains) {
    grain.clump = static_cast<int>(clumps.clumps.size());
    clumps.clumps.push_back({{{{0, 0}, grain.radius}}});
  }
  GrainSimulation expected(discs, options_of(stepping, 0.005)), found(clumps, options_of(stepping, 0.005));
  double difference = 0;
  for (int k = 0; k < (overlap ? 20 : 300); ++k) {
    expected.advance(1);
    found.advance(1);
  }
  const std::vector<Grain> one = expected.grains(), two = found.grains();
  for (std::size_t k = 0; k < one.size(); ++k) {
    difference = std::max({difference, norm(one[k].position - two[k].position), std::abs(one[k].spin - two[k].spin)});
  }
  CAPTURE(stepping.name(), overlap, difference, expected.counters().contacts);
  CHECK(expected.counters().contacts > 10);
  CHECK(found.counters().contacts == expected.counters().contacts);
  CHECK(difference < 1e-10);
}

TEST_CASE("an_impact_turns_a_rigid_pair_by_its_arm") {
  // Without friction the impulse P of the floor gives m dv = P, I dw = arm P; the smaller mass 1/(1/m + arm²/I)
  // rebounds elastically.
  const double angle = GENERATE(0.2, 0.7, 1.2);
  GrainScene scene = scene_of({}, {line("floor", {0, 0}, {0, 1})}, {.stiffness = 1e8});
  const double height = 1 + std::sin(angle), arm = -std::cos(angle);
  scene.grains = {lump(scene, pair_of_discs(), {0, height + 1e-7}, angle, {0, -1})};
  GrainSimulation simulation(scene, options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 2e-7));
  REQUIRE(pass_contact(simulation, 20000));
  const Grain out = simulation.grains()[0];
  const double moment = scene.grains[0].inertia.moment, impulse = 2 / (1 + arm * arm / moment);
  CAPTURE(angle, moment, out.velocity.y, out.spin, impulse);
  CHECK(moment == Approx(1.5).epsilon(1e-14));
  CHECK(out.velocity.y == Approx(impulse - 1).margin(2e-3));
  CHECK(out.spin == Approx(arm * impulse / moment).margin(2e-3));
}

TEST_CASE("a_rigid_pair_stands_on_both_its_discs") {
  PairProperties pair;
  pair.stiffness = 1e4;
  pair.restitution = 0.3;
  pair.end = ContactEnd::at_zero_overlap;
  GrainScene scene = scene_of({}, {line("floor", {0, 0}, {0, 1})}, pair, {0, -10});
  scene.grains = {lump(scene, {{{0, 0}, 1}, {{2, -0.5}, 0.5}}, {0, 1.3}, 0.3)};
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 1e-3));
  simulation.advance(20000);
  const std::vector<GrainContact> contacts = simulation.contacts();
  CAPTURE(contacts.size(), simulation.grains()[0].angle, simulation.grains()[0].spin);
  REQUIRE(contacts.size() == 2);
  CHECK(contacts[0].normal_force + contacts[1].normal_force == Approx(10).epsilon(1e-6));
  // the moments of both about the centre of mass cancel
  const double moment = contacts[0].arm_i.x * contacts[0].normal_force + contacts[1].arm_i.x * contacts[1].normal_force;
  CHECK(std::abs(moment) < 1e-6);
}

TEST_CASE("contacts_of_all_shapes_keep_linear_and_angular_momentum") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const bool enlarged = GENERATE(false, true);
  GrainScene scene = busy_box(stepping.law, 4, 4, 51);
  scene.grains = mixed_grains(scene, 4, 4, 51);
  scene.walls.clear();
  scene.gravity = {};
  for (Grain& grain : scene.grains) grain.velocity -= 0.5 * (grain.position - Vec2{2, 2});
  GrainOptions options = options_of(stepping, 0.004);
  if (enlarged) options.ellipse_law = GrainOptions::EllipseLaw::enlarged;
  GrainSimulation simulation(scene, options);
  const auto momentum = [&] {
    Vec2 linear = {};
    double angular = 0;
    for (const Grain& grain : simulation.grains()) {
      linear += grain.inertia.mass * grain.velocity;
      angular += grain.inertia.mass * cross(grain.position, grain.velocity) + grain.inertia.moment * grain.spin;
    }
    return std::pair(linear, angular);
  };
  const auto [linear, angular] = momentum();
  double moved = 0, turned = 0;
  for (int k = 0; k < 500; ++k) {
    simulation.advance(1);
    const auto [now, turning] = momentum();
    moved = std::max(moved, norm(now - linear));
    turned = std::max(turned, std::abs(turning - angular));
  }
  CAPTURE(stepping.name(), enlarged, moved, turned, simulation.counters().contacts);
  CHECK(simulation.counters().contacts > 20);
  CHECK(moved < 1e-12);
  // Euler moves bodies while their contact holds still: forces act where they were
  CHECK(turned < 1e-12);
}

TEST_CASE("the_ledger_of_mixed_shapes_closes_with_the_step") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  std::vector<double> errors;
  for (const double step : {0.004, 0.002, 0.001, 0.0005}) {
    GrainSimulation simulation(mixed_box(stepping.law, 3, 3, 61), options_of(stepping, step));
    double worst = 0;
    while (simulation.time() < 1.5) {
      simulation.advance(1);
      worst = std::max(worst, std::abs(simulation.energy().error()) / simulation.energy().initial);
    }
    errors.push_back(worst);
  }
  const double order = std::log2(errors.front() / errors.back()) / 3;
  CAPTURE(stepping.name(), errors, order);
  CHECK(errors.back() < 0.03);
  CHECK(order > 0.8);
}
