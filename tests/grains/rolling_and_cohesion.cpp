// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rolling resistance and cohesion by closed forms, and in the ledger.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"

#include "grains/bonded_scenes.hpp"
#include "grains/cell_scenes.hpp"
#include "grains/resuming.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Contacts that last `duration` s at e = 1, damped, with friction that holds.
PairProperties rough(NormalLaw law, double duration, double rolling_friction) {
  PairProperties pair = one_second(law, 0.3);
  pair.stiffness /= duration * duration;
  pair.friction = 1;
  pair.tangential_ratio = 2.0 / 7;
  pair.tangential_damping = 0.3;
  pair.rolling_friction = rolling_friction;
  pair.rolling_ratio = 2.0 / 7;
  pair.rolling_damping = 0.3;
  return pair;
}

PairProperties sticky(NormalLaw law, double duration, double cohesion, double range) {
  PairProperties pair = one_second(law, 0.3);
  pair.stiffness /= duration * duration;
  pair.cohesion = cohesion;
  pair.cohesion_range = range;
  return pair;
}

GrainOptions options_for(const Stepping& stepping, double duration) {
  return options_of(stepping, duration / 40);
}

void run(GrainSimulation& simulation, double time, const GrainOptions& options) {
  simulation.advance(std::llround(time / options.time_step));
}

}  // namespace

TEST_CASE("a_disc_on_an_incline_starts_to_roll_where_its_slope_exceeds_the_rolling_friction") {
  // (1 + beta) a = g (sin - mu_r cos), beta = I/(m R²)
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double mu = GENERATE(0.05, 0.3), beta = GENERATE(0.4, 0.5);
  const double duration = 0.02, slope = GENERATE(0.95, 1.05, 2.0);
  const GrainOptions options = options_for(stepping, duration);
  const double angle = std::atan(slope * mu);
  GrainSimulation simulation(scene_of({ball({0, 1}, 1, {}, 1, beta)}, {line("floor", {0, 0}, {0, 1})},
                                      rough(stepping.law, duration, mu), {std::sin(angle), -std::cos(angle)}),
                             options);
  run(simulation, 2, options);
  const Grain before = simulation.grains()[0];
  run(simulation, 8, options);
  const Grain after = simulation.grains()[0];
  const double expected = slope < 1 ? 0 : 8 * (std::sin(angle) - mu * std::cos(angle)) / (1 + beta);
  CAPTURE(stepping.name(), mu, slope, beta, after.velocity.x, before.velocity.x, expected);
  CHECK(std::abs(after.velocity.x - before.velocity.x - expected) < 0.01 * 8 * mu);
  CHECK(std::abs(after.velocity.x + after.spin) < 1e-3);  // it rolls, and does not slip
  if (slope < 1) CHECK(std::abs(after.position.x - before.position.x) < 1e-3);
  // the moment of rolling is what friction exerts about the centre, and the wall gets it too
  const GrainContact contact = simulation.contacts().at(0);
  if (slope < 1) {
    CHECK(std::abs(contact.moment) == Approx(std::abs(contact.tangential_force)).epsilon(0.01));
    const Vec2 force = contact.normal_force * contact.normal + contact.tangential_force * perpendicular(contact.normal);
    const double of_force = cross(after.position + contact.arm_i, force);
    CHECK(simulation.walls()[0].moment == Approx(of_force + contact.moment).epsilon(1e-6).margin(1e-6));
  } else {
    CHECK(std::abs(contact.moment) == Approx(mu * contact.normal_force).epsilon(1e-9));
  }
}

TEST_CASE("a_disc_that_rolls_on_a_floor_stops_after_the_way_of_its_rolling_friction") {
  // v²(1 + beta)/(2 mu_r g), beta = 1/2; all its energy is lost by rolling
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double duration = 0.02, mu = GENERATE(0.1, 0.3);
  const GrainOptions options = options_for(stepping, duration);
  GrainScene scene =
      scene_of({ball({0, 1}, 1)}, {line("floor", {0, 0}, {0, 1})}, rough(stepping.law, duration, mu), {0, -1});
  scene.grains[0].position.y = 1 - overlap_under(1, stepping.law, scene.pairs[0].stiffness);
  scene.grains[0].velocity.x = 0.6;
  scene.grains[0].spin = -0.6;
  GrainSimulation simulation(scene, options);
  const double time = 0.6 * 1.5 / mu;
  run(simulation, time + 2, options);
  const Grain end = simulation.grains()[0];
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(stepping.name(), mu, end.position.x, ledger.lost_rolling, ledger.initial, ledger.lost());
  CHECK(end.position.x == Approx(0.6 * 0.6 * 1.5 / (2 * mu)).epsilon(0.01));
  CHECK(std::abs(end.velocity.x) < 1e-3);
  CHECK(ledger.lost_rolling == Approx(0.75 * 0.6 * 0.6).epsilon(0.02));
  CHECK(std::abs(ledger.error()) < 0.01 * ledger.initial);
}

TEST_CASE("two_discs_roll_against_each_other_by_their_reduced_radius") {
  // a pair under a constant push, whose slip is free: only the rolling moment mu_r R N slows the relative spin
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double duration = 0.05, mu = 0.2, push = 1;
  const GrainOptions options = options_for(stepping, duration);
  PairProperties pair = rough(stepping.law, duration, mu);
  pair.friction = pair.tangential_damping = 0;
  std::vector<Grain> grains{ball({0, 0.5}, 0.5, {}, 1), ball({0, 2}, 1, {}, 4)};
  for (const double force : {5 * push, 4 * push})
    grains[1].position.y -= overlap_under(force, stepping.law, pair.stiffness);
  grains[1].spin = 3;
  GrainSimulation simulation(scene_of(grains, {line("floor", {0, 0}, {0, 1})}, pair, {0, -push}), options);
  run(simulation, 0.2, options);
  const double start = simulation.grains()[1].spin;
  const double time = 0.5;
  run(simulation, time, options);
  // the disc above weighs 4; R = 0.5 * 1/(1.5), I = 4/2
  const double expected = mu * (0.5 / 1.5) * 4 * push / 2 * time;
  CAPTURE(stepping.name(), start, simulation.grains()[1].spin, expected);
  CHECK(start - simulation.grains()[1].spin == Approx(expected).epsilon(0.02));
}

TEST_CASE("a_disc_hangs_as_long_as_its_weight_is_below_the_cohesion") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double duration = 0.05, cohesion = 2, share = GENERATE(0.99, 1.01);
  const GrainOptions options = options_for(stepping, duration);
  GrainSimulation simulation(scene_of({ball({0, -1}, 1)}, {line("lid", {0, 0}, {0, -1})},
                                      sticky(stepping.law, duration, cohesion, 0.05), {0, -share * cohesion}),
                             options);
  run(simulation, 40, options);
  CAPTURE(stepping.name(), share, simulation.grains()[0].position.y);
  CHECK((simulation.grains()[0].position.y > -1.1) == (share < 1));
}

TEST_CASE("two_discs_part_where_their_motion_exceeds_the_work_of_cohesion") {
  // from rest at the overlap d = F/k: F (d + range) - k d²/2 = F range + F²/(2 k); hertz: F range + 3/5 F d, d =
  // (F/k)^(2/3)
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double duration = 0.05, cohesion = 2, range = 0.05, share = GENERATE(0.98, 1.02);
  const GrainOptions options = options_of(stepping, duration / 400);
  PairProperties pair = sticky(stepping.law, duration, cohesion, range);
  pair.restitution = 1;
  const double depth = overlap_under(cohesion, stepping.law, pair.stiffness);
  const double work = cohesion * range + cohesion * depth * (stepping.law == NormalLaw::hertz_dashpot ? 0.6 : 0.5);
  const double speed = std::sqrt(share * 2 * work / 0.5);  // reduced mass 1/2
  GrainSimulation simulation(
      scene_of({ball({-1, 0}, 1, {-speed / 2, 0}), ball({1 - depth, 0}, 1, {speed / 2, 0})}, {}, pair), options);
  CHECK(simulation.energy().cohesion == Approx(-cohesion * (depth + range)).epsilon(0.02));
  run(simulation, 1, options);
  const double gap = simulation.grains()[1].position.x - simulation.grains()[0].position.x - 2;
  CAPTURE(stepping.name(), share, gap);
  CHECK((gap > range) == (share > 1));
  CHECK(std::abs(simulation.energy().error()) < 0.002 * work);
}

TEST_CASE("friction_of_a_cohesive_contact_is_limited_by_the_repulsion") {
  // a disc at a vertical wall, where N = 0: mu (N + F_c) carries its weight, and mu_r (N + F_c) R its moment
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double duration = 0.05, cohesion = 2, share = GENERATE(0.95, 1.2);
  const bool rolls = GENERATE(false, true);
  const GrainOptions options = options_for(stepping, duration);
  PairProperties pair = rough(stepping.law, duration, rolls ? 0.4 : 4);
  pair.friction = rolls ? 4 : 0.4;
  pair.cohesion = cohesion;
  pair.cohesion_range = 0.05;
  const double depth = overlap_under(cohesion, stepping.law, pair.stiffness);
  GrainSimulation simulation(
      scene_of({ball({1 - depth, 0}, 1)}, {line("left", {0, 0}, {1, 0})}, pair, {0, -share * 0.4 * cohesion}), options);
  run(simulation, 1, options);
  const double before = simulation.grains()[0].velocity.y;
  run(simulation, 2, options);
  const double gain = simulation.grains()[0].velocity.y - before;
  const double expected = share < 1 ? 0 : -2 * (share - 1) * 0.4 * cohesion / (rolls ? 1.5 : 1);
  CAPTURE(stepping.name(), share, rolls, gain, expected);
  CHECK(std::abs(gain - expected) < 0.02);
}

namespace {

enum class ShapeOfTest { disc, ellipse, clump };

/// Of mass 1, whose side lies at x = +-0.5 at the height of its centre.
Grain body_of(GrainScene& scene, ShapeOfTest shape, Vec2 centre) {
  switch (shape) {
    case ShapeOfTest::disc:
      return ball(centre, 0.5);
    case ShapeOfTest::ellipse:
      return oval(centre, 0.5, 0.3);
    case ShapeOfTest::clump:
      break;
  }
  return lump(scene, {{{-0.2, 0}, 0.3}, {{0.2, 0}, 0.3}}, centre);
}

}  // namespace

TEST_CASE("bodies_of_all_shapes_attract_each_other_within_the_range_and_keep_their_momenta") {
  // from rest at a gap g: they meet at v² = 2 F g/m, m the reduced mass
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const ShapeOfTest first = GENERATE(ShapeOfTest::disc, ShapeOfTest::ellipse, ShapeOfTest::clump);
  const ShapeOfTest second = GENERATE(ShapeOfTest::disc, ShapeOfTest::ellipse, ShapeOfTest::clump);
  const bool at_wall = GENERATE(false, true);
  if (at_wall && second != ShapeOfTest::disc) return;
  const double gap = 0.04, cohesion = 1;
  GrainScene scene = scene_of({}, {}, sticky(stepping.law, 0.1, cohesion, 0.05));
  scene.grains.push_back(body_of(scene, first, {0, 0}));
  if (at_wall) {
    scene.walls.push_back(segment("right", {0.5 + gap, -3}, {0.5 + gap, 3}));
  } else {
    scene.grains.push_back(body_of(scene, second, {1 + gap, 0}));
  }
  const double mass = at_wall ? 1 : 0.5;
  GrainSimulation simulation(scene, options_of(stepping, 1e-4));
  const double initial = simulation.energy().initial;
  CHECK(initial == Approx(-cohesion * (0.05 - gap)).epsilon(1e-9));
  const auto closing = [&] {
    const std::vector<Grain> now = simulation.grains();
    return now[0].velocity.x - (at_wall ? 0 : now[1].velocity.x);
  };
  simulation.advance(1);
  while (simulation.step() < 20000 && !simulation.contacts().empty() && simulation.contacts()[0].overlap <= 0)
    simulation.advance(1);
  CAPTURE(stepping.name(), static_cast<int>(first), static_cast<int>(second), at_wall, simulation.step());
  CHECK(closing() == Approx(std::sqrt(2 * cohesion * gap / mass)).epsilon(0.01));
  simulation.advance(40000);
  const EnergyLedger ledger = simulation.energy();
  CHECK(std::abs(ledger.error()) < 0.02 * cohesion * gap);
  CHECK(ledger.lost_dashpot > 0);
  CHECK(simulation.contacts().size() == 1);  // they stick
  if (at_wall) return;
  const Momenta sum = momenta_of(simulation.grains());
  CHECK(norm(sum.linear) < 1e-12);
  CHECK(std::abs(sum.angular) < 1e-12);
}

TEST_CASE("stages_take_over_rolling_and_cohesion_and_the_ledger_closes_over_them") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const GrainScene plain = busy_box(stepping.law, 4, 4, 21), effects = with_effects(plain, 2);
  GrainScene rolling = effects;
  rolling.pairs[0].cohesion = rolling.pairs[0].cohesion_range = 0;
  std::vector<GrainStage> stages;
  for (const GrainScene& scene : {plain, effects, rolling, plain})
    stages.push_back({.name = fmt::format("stage {}", stages.size()), .scene = still(scene), .steps = 300});
  const StagedSimulation last = check_resuming(stages, options_of(stepping, 0.002), 100);
  const EnergyLedger ledger = last.energy();
  CAPTURE(stepping.name(), ledger.error(), ledger.largest());
  CHECK(std::abs(ledger.error()) < 0.02 * ledger.largest());
  CHECK(ledger.lost_rolling > 0);
  CHECK(ledger.cohesion == 0);
  CHECK(ledger.elastic_rolling == 0);
}

TEST_CASE("rolling_and_cohesion_are_refused_where_nothing_carries_them") {
  const auto refuses = [](const std::string& words, const Stepping& stepping, auto change) {
    GrainScene scene = busy_box(stepping.law, 2, 2, 1);
    GrainOptions options = options_of(stepping, 0.001);
    change(scene.pairs[0], options);
    check_refused([&] { check(scene, options); }, {words});
  };
  const auto rolls = [](PairProperties& pair, GrainOptions&) { pair.rolling_friction = pair.rolling_ratio = 0.3; };
  for (const Stepping& without_force : steppings_by_force(false)) refuses("linear_dashpot", without_force, rolls);
  refuses("without a rolling spring", all_steppings[0], [](PairProperties& p, auto&) { p.rolling_friction = 0.3; });
  refuses("without rolling friction", all_steppings[0], [](PairProperties& p, auto&) { p.rolling_damping = 0.3; });
  refuses("without its range", all_steppings[0], [](PairProperties& p, auto&) { p.cohesion = 0.3; });
  refuses("without a force", all_steppings[0], [](PairProperties& p, auto&) { p.cohesion_range = 0.3; });
  refuses("enlarged ellipses", all_steppings[0], [&](PairProperties& p, GrainOptions& o) {
    rolls(p, o);
    o.ellipse_law = GrainOptions::EllipseLaw::enlarged;
  });
}
