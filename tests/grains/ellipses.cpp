// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Ellipses and clumps that meet, rebound, rest and rock, and the packed loops over pairs of discs and of parts.
#include "equidem/geometry/shape_contact.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"

#include "grains/bonded_scenes.hpp"
#include "grains/resuming.hpp"
#include "grains/scenes.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Wall floor_line() {
  return line("floor", {0, 0}, {0, 1});
}

/// Largest error of the ledger over some time.
double ledger_error(const GrainScene& scene, const GrainOptions& options, double time) {
  GrainSimulation simulation(scene, options);
  double worst = 0;
  while (simulation.time() < time) {
    simulation.advance(1);
    worst = std::max(worst, std::abs(simulation.energy().error()));
  }
  CHECK(simulation.counters().contacts > 1);
  return worst;
}

}  // namespace

TEST_CASE("an_ellipse_of_aspect_one_and_a_clump_of_one_disc_move_as_the_disc") {
  // exactly round: the disc law; all but round: the closest points of ellipses
  struct Round {
    const char* name;
    bool clump = false, overlap = false;  ///< overlap: at the start
    double less = 0;
  };
  const Stepping stepping = GENERATE(from_range(force_steppings));
  for (const Round& round : {Round{"ellipse"}, Round{"all but round", false, false, 1e-14}, Round{"clump", true},
                             Round{"clump that overlaps", true, true}}) {
    GrainScene discs = busy_box(stepping.law, 3, 3, 31);
    for (Grain& grain : discs.grains) grain.radius *= round.overlap ? 1.25 : 1;
    GrainScene scene = discs;
    for (Grain& grain : scene.grains) {
      if (!round.clump) {
        grain.short_half_axis = grain.radius * (1 - round.less);
        continue;
      }
      grain.clump = static_cast<int>(scene.clumps.size());
      scene.clumps.push_back({{{{0, 0}, grain.radius}}});
    }
    GrainSimulation expected(discs, options_of(stepping, 0.005)), found(scene, options_of(stepping, 0.005));
    expected.advance(round.overlap ? 20 : 300);
    found.advance(round.overlap ? 20 : 300);
    const double difference = distance_of(expected.grains(), found.grains());
    CAPTURE(stepping.name(), round.name, difference, expected.counters().contacts);
    CHECK(expected.counters().contacts > 10);
    CHECK(found.counters().contacts == expected.counters().contacts);
    CHECK(difference < 1e-10);
  }
}

TEST_CASE("a_central_impact_of_ellipses_has_the_restitution_of_discs") {
  // The masses alone say how an impact goes as long as the normal passes through both centres: tip on tip, side on
  // side.
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double e = GENERATE(0.5, 1.0);
  const bool sides = GENERATE(false, true);
  const double turn = sides ? std::numbers::pi / 2 : 0;
  const double size = sides ? 0.3 : 1;
  const PairProperties pair = one_second(stepping.law, e, 0.5);
  const auto rebound = [&](Grain a, Grain b) {
    GrainSimulation simulation(scene_of({a, b}, {}, pair), options_of(stepping, 0.005));
    REQUIRE(pass_contact(simulation, 1000));
    return simulation.grains();
  };
  const std::vector<Grain> expected =
      rebound(ball({-size - 0.01, 0}, size, {0.05, 0}), ball({size, 0}, size, {-0.05, 0}));
  const std::vector<Grain> found =
      rebound(oval({-size - 0.01, 0}, 1, 0.3, turn, {0.05, 0}), oval({size, 0}, 1, 0.3, turn, {-0.05, 0}));
  for (std::size_t k = 0; k < 2; ++k) {
    CAPTURE(stepping.name(), e, sides, k, found[k].velocity.x, expected[k].velocity.x, found[k].spin);
    CHECK(std::abs(found[k].velocity.x - expected[k].velocity.x) < 1e-12);
    CHECK(std::abs(found[k].velocity.y) < 1e-12);
    CHECK(std::abs(found[k].spin) < 1e-12);
  }
}

TEST_CASE("an_eccentric_impact_has_the_restitution_of_its_smaller_mass") {
  // zeta' = zeta sqrt(m/m'), 1/m' = 1/m + arm²/I (force_step.hpp); hard enough that the body hardly turns meanwhile.
  const ContactEnd end = GENERATE(ContactEnd::at_zero_force, ContactEnd::at_zero_overlap);
  const double angle = GENERATE(0.3, 0.8, 1.3);
  PairProperties pair{.stiffness = 1e8, .restitution = 0.6, .end = end};
  const Ellipse shape = Ellipse::at_angle(1, 0.3, angle);
  const auto support_down = support(shape, {0, -1});
  const double arm = support_point(support_down, {0, -1}).x, moment = (1 + 0.09) / 4;
  const double mass = 1 / (1 + arm * arm / moment);
  const Grain grain = oval({0, support_down.reach + 1e-7}, 1, 0.3, angle, {0, -1});
  GrainSimulation simulation(scene_of({grain}, {floor_line()}, pair),
                             options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 2e-7));
  REQUIRE(pass_contact(simulation, 10000));
  const Grain out = simulation.grains()[0];
  const double found = out.velocity.y + out.spin * arm;
  const double expected = restitution_of(damping_ratio_of(0.6, end) / std::sqrt(mass), end);
  CAPTURE(to_string(end), angle, arm, mass, found, expected);
  CHECK(std::abs(found - expected) < 2e-3);
  // one impulse does both; the arm changes as the body turns, by 1e-4
  CHECK(std::abs(out.spin * moment - arm * (out.velocity.y + 1)) < 1e-3);
}

TEST_CASE("the_ledger_of_an_elastic_ellipse_closes_with_the_order_of_the_integrator") {
  // The gradient of the exact gap is the normal: the force has an energy, k overlap²/2.
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const bool on_floor = GENERATE(true, false);
  PairProperties pair = one_second(stepping.law, 1, 0.5);
  pair.stiffness *= 10;
  GrainScene scene = on_floor
                         ? scene_of({oval({0, 1.5}, 1, 0.4, 0.6)}, {floor_line()}, pair, {0.1, -1})
                         : scene_of({oval({0, 0}, 1, 0.4, 0.6, {0.3, 0}), oval({2.1, 0.5}, 1, 0.2, -0.4, {-0.3, 0}),
                                     oval({-2.1, 0.3}, 1, 0.2, 0.9, {0.5, 0})},
                                    {}, pair);
  if (!on_floor) scene.grains[0].spin = 0.3;
  std::vector<double> errors;
  for (const double step : {0.004, 0.002, 0.001}) {
    errors.push_back(ledger_error(scene, options_of(stepping, step), 6));
  }
  const double order = std::log2(errors.front() / errors.back()) / 2;
  CAPTURE(stepping.name(), on_floor, errors, order);
  const bool second = stepping.integrator != GrainIntegrator::semi_implicit_euler;
  CHECK(errors.back() < (second ? 1e-4 : 1e-2));
  CHECK(order > (second ? 1.7 : 0.85));
}

TEST_CASE("an_ellipse_dropped_flat_comes_to_rest_on_its_side") {
  const auto shape = GENERATE(Wall::Shape::line, Wall::Shape::segment);
  PairProperties pair{.stiffness = 1e4,
                      .restitution = 0.3,
                      .end = ContactEnd::at_zero_overlap,
                      .friction = 0.5,
                      .tangential_ratio = 0.5};
  const Wall wall = shape == Wall::Shape::line ? floor_line() : segment("floor", {-9, 0}, {9, 0});
  GrainSimulation simulation(scene_of({oval({0, 0.6}, 1, 0.5)}, {wall}, pair, {0, -9.81}),
                             options_of(NormalLaw::linear_dashpot, 1e-3));
  simulation.advance(5000);
  const Grain rest = simulation.grains()[0];
  CAPTURE(static_cast<int>(shape), rest.position.y, rest.angle, rest.spin, norm(rest.velocity));
  CHECK(std::abs(rest.position.y - (0.5 - 9.81 / 1e4)) < 1e-12);
  CHECK(norm(rest.velocity) + std::abs(rest.spin) + std::abs(rest.angle) < 1e-10);
  REQUIRE(simulation.contacts().size() == 1);
  CHECK(simulation.contacts()[0].normal_force == Approx(9.81).epsilon(1e-10));
  CHECK(norm(simulation.contacts()[0].arm_i - Vec2{0, -0.5}) < 1e-9);
}

TEST_CASE("an_ellipse_on_a_rough_floor_rocks_with_its_period") {
  // Rolling without slip about its lowest point: w² = m g (a²/b - b)/(I + m b²).
  PairProperties pair{.stiffness = 1e6, .restitution = 1, .friction = 100, .tangential_ratio = 1};
  const double a = 1, b = 0.8, g = 10, tilt = 0.01;
  const Ellipse shape = Ellipse::at_angle(a, b, tilt);
  const double height = support(shape, {0, -1}).reach - g / 1e6;
  GrainSimulation simulation(scene_of({oval({0, height}, a, b, tilt)}, {floor_line()}, pair, {0, -g}),
                             options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 2e-4));
  double before = tilt, crossing = 0;
  int crossings = 0;
  while (crossings < 4 && simulation.time() < 20) {
    simulation.advance(1);
    const double now = simulation.grains()[0].angle;
    if (before * now < 0) {
      ++crossings;
      crossing = simulation.time() - 2e-4 * now / (now - before);
    }
    before = now;
  }
  const double w = std::sqrt(g * (a * a / b - b) / ((a * a + b * b) / 4 + b * b));
  const double expected = 3.5 * std::numbers::pi / w;
  CAPTURE(crossings, crossing, expected);
  REQUIRE(crossings == 4);
  CHECK(crossing == Approx(expected).epsilon(1e-3));
}

TEST_CASE("sukegawas_test_holds_the_overlap_that_it_implies") {
  // Moved by its overlap along its normal the pair is judged to touch no more; where the test holds the ellipses
  // overlap.
  Random random(9);
  int contacts = 0;
  double worst = 0, invented = -1;
  for (int k = 0; k < 2000; ++k) {
    const Ellipse i = Ellipse::at_angle(1, random.uniform(0.2, 1), random.uniform(-4, 4));
    const Ellipse j = Ellipse::at_angle(random.uniform(0.5, 1.5), 0.3, random.uniform(-4, 4));
    const double angle = random.uniform(-4, 4);
    const Vec2 branch = random.uniform(1, 2) * Vec2{std::cos(angle), std::sin(angle)};
    const EllipseContact contact = contact_by_enlarged_ellipse(i, j, branch);
    const double judged = enlarged_ellipse_contact(i, j, branch).judgement;
    if (std::abs(judged) < 1e-12) continue;
    REQUIRE(contact.is_contact() == (judged < 0));
    if (!contact.is_contact()) continue;
    ++contacts;
    const Vec2 moved = branch - contact.gap * contact.normal;
    worst = std::max(worst, std::abs(enlarged_ellipse_contact(i, j, moved).judgement));
    invented = std::max(invented, contact_of_ellipses(i, j, branch).gap);
  }
  CAPTURE(contacts, worst, invented);
  CHECK(contacts > 200);
  CHECK(worst < 1e-10);
  CHECK(invented < 0);
}

TEST_CASE("ellipses_by_sukegawas_test_rebound_as_discs_where_they_are_all_but_round") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  using EllipseLaw = GrainOptions::EllipseLaw;
  GrainScene scene = scene_of({oval({0, 0}, 1, 1 - 1e-9, 0.3, {0.1, 0}), oval({2.05, 0.4}, 1, 1 - 1e-9, 2)}, {},
                              one_second(stepping.law, 1, 0.5));
  GrainOptions options = options_of(stepping, 0.005);
  GrainSimulation exact(scene, options);
  exact.advance(600);
  REQUIRE(exact.counters().contacts == 1);
  options.ellipse_law = EllipseLaw::enlarged;
  GrainSimulation mended(scene, options);
  mended.advance(600);
  const double difference = distance_of(exact.grains(), mended.grains());
  CAPTURE(stepping.name(), difference);
  CHECK(difference < 1e-7);
}

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
  PairProperties pair{.stiffness = 1e4, .restitution = 0.3, .end = ContactEnd::at_zero_overlap};
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

// Any number beside zero grows there: a column is as unstable as a rod on its tip.
TEST_CASE("discs_above_one_another_stay_so_to_the_last_bit") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double friction = GENERATE(0.0, 0.4);
  std::vector<Grain> column;
  for (int k = 0; k < 20; ++k) column.push_back(ball({0, 1.0 + 1.99 * k}, 1));
  PairProperties pair{.stiffness = 1e4, .restitution = 0.5, .friction = friction, .tangential_ratio = 0.5};
  GrainSimulation simulation(scene_of(column, {line("floor", {0, 0}, {0, 1})}, pair, {0, -1}),
                             options_of(stepping, 0.001));
  simulation.advance(500);
  CAPTURE(stepping.name(), friction);
  CHECK(simulation.counters().contacts > 19);
  for (const Grain& grain : simulation.grains()) {
    CHECK(grain.position.x == 0);
    CHECK(grain.velocity.x == 0);
    CHECK(grain.spin == 0);
  }
}
