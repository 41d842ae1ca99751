// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Ellipses that meet, rebound, rest and rock.
#include "equidem/geometry/shape_contact.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"

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
  PairProperties pair;
  pair.stiffness = 1e8;
  pair.restitution = 0.6;
  pair.end = end;
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
  PairProperties pair;
  pair.stiffness = 1e4;
  pair.restitution = 0.3;
  pair.end = ContactEnd::at_zero_overlap;
  pair.friction = 0.5;
  pair.tangential_ratio = 0.5;
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
  PairProperties pair;
  pair.stiffness = 1e6;
  pair.restitution = 1;
  pair.friction = 100;
  pair.tangential_ratio = 1;
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
