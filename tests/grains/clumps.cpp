// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Clumps of discs: mass, motion, contacts.
#include "grains/bonded_scenes.hpp"
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

TEST_CASE("contacts_of_all_shapes_rolling_cohesion_and_bonds_keep_linear_and_angular_momentum") {
  // Euler moves bodies while their contact holds still: forces act where they were.
  struct Free {
    const char* name;
    GrainScene scene;
    double step;
    int steps;
    double linear, angular;  ///< round-off
    int least_contacts;
    bool enlarged = false;
  };
  const Stepping stepping = GENERATE(from_range(all_steppings));
  if (stepping.law == NormalLaw::five_case_map || stepping.law == NormalLaw::exact_flow) return;
  GrainScene shapes = mixed_box(stepping.law, 4, 4, 51), sticky = with_effects(mixed_box(stepping.law, 3, 2, 5), 3);
  for (Grain& grain : shapes.grains) grain.velocity -= 0.5 * (grain.position - Vec2{2, 2});
  for (Grain& grain : sticky.grains) {
    grain.position = 0.9 * grain.position;
    grain.velocity = grain.velocity - 0.7 * (grain.position - Vec2{1.35, 0.9});
  }
  for (GrainScene* scene : {&shapes, &sticky}) scene->walls.clear(), scene->gravity = {};
  const GrainScene chain = chain_scene(stepping.law, 7, all_of_a_bond);
  std::vector<Free> scenes{{"bonds", chain, 0.9 * explicit_step_limit(chain), 500, 1e-13, 1e-12, -1}};
  if (gives_force(stepping.law)) {
    scenes.push_back({"shapes", shapes, 0.004, 500, 1e-12, 1e-12, 20});
    scenes.push_back({"enlarged ellipses", shapes, 0.004, 500, 1e-12, 1e-12, 20, true});
    scenes.push_back({"rolling and cohesion", sticky, 0.001, 4000, 1e-11, 1e-11, 3});
  }
  for (const Free& free : scenes) {
    GrainOptions options = options_of(stepping, free.step);
    if (free.enlarged) options.ellipse_law = GrainOptions::EllipseLaw::enlarged;
    GrainSimulation simulation(free.scene, options);
    const Momenta before = momenta_of(simulation.grains());
    double moved = 0, turned = 0;
    for (int k = 0; k < free.steps; k += 10) {
      simulation.advance(10);
      const Momenta now = momenta_of(simulation.grains());
      moved = std::max(moved, norm(now.linear - before.linear));
      turned = std::max(turned, std::abs(now.angular - before.angular));
    }
    CAPTURE(stepping.name(), free.name, moved, turned, simulation.counters().contacts);
    CHECK(simulation.counters().contacts > free.least_contacts);
    CHECK((simulation.energy().lost_rolling > 0) == (free.scene.pairs[0].rolling_friction > 0));
    CHECK(moved < free.linear);
    CHECK(turned < free.angular);
  }
}
