// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The critical step against experiment and closed forms, and what is refused.
#include "equidem/dynamics/time_step.hpp"

#include <cmath>
#include <numbers>

#include "equidem/core/stopwatch.hpp"

#include "dynamics/moving_scenes.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Whether a small random motion grows without end in so many steps of that length.
bool grows(const Scene& scene, SimulationOptions options, double step) {
  const ThreadsFor one(1);
  options.time_step = step;
  Scene moving = scene;
  start_with(moving, random_motions(scene.assembly.size(), 3, 1e-3, 1e-3));
  Simulation run(moving, options);
  const auto size = [&] {
    double sum = 0;
    for (const DiscMotion& v : run.velocities()) sum += dot(v.u, v.u) + v.theta * v.theta;
    return sum;
  };
  const double first = size();
  // The thesis's scheme grows slowly past its lower limit.
  const int chunk = options.integrator == Integrator::thesis ? 2000 : 200;
  for (int k = 0; k < 20; ++k) {
    run.advance(chunk);
    if (!(size() < 1e4 * first)) return true;
  }
  return false;
}

/// The step at which growth begins, by halving, to 0.2 %.
double measured_limit(const Scene& scene, const SimulationOptions& options, double guess) {
  double stable = 0.5 * guess, unstable = 1.5 * guess;
  while (unstable - stable > 2e-3 * guess) {
    const double middle = 0.5 * (stable + unstable);
    (grows(scene, options, middle) ? unstable : stable) = middle;
  }
  return 0.5 * (stable + unstable);
}

}  // namespace

TEST_CASE("instability_begins_at_the_predicted_critical_step") {
  struct Given {
    Integrator integrator;
    Damping damping;
  };
  const Given given = GENERATE(
      Given{Integrator::leapfrog, {}}, Given{Integrator::velocity_verlet, {}}, Given{Integrator::fourth_order, {}},
      Given{Integrator::leapfrog, {.mass = 0.3}}, Given{Integrator::leapfrog, {.stiffness = 0.2}},
      Given{Integrator::leapfrog, {.contact = 0.3}}, Given{Integrator::leapfrog, {.local = 0.3}},
      Given{Integrator::leapfrog, {.local = 0.8}}, Given{Integrator::leapfrog, {.mass = 0.2, .contact = 0.1}},
      Given{Integrator::thesis, {.stiffness = 0.05}}, Given{Integrator::thesis, {.stiffness = 1.5}},
      Given{Integrator::thesis, {.mass = 3}}, Given{Integrator::thesis, {.mass = 20}});
  const bool hexagonal = GENERATE(true, false);
  const Assembly assembly = hexagonal ? hexagonal_block(5) : delaunay_block(30, 2);
  const ContactSprings springs(SpringConstants{1, 0.4});
  const Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  const SimulationOptions options{.integrator = given.integrator, .damping = given.damping};
  const TimeStep chosen = choose_time_step(scene, options, {.fraction = 1});
  const double measured = measured_limit(scene, options, chosen.critical);
  CAPTURE(to_string(given.integrator), given.damping.mass, given.damping.stiffness, given.damping.contact,
          given.damping.local, hexagonal, chosen.critical, measured, chosen.report());
  CHECK(chosen.exact);
  CHECK(measured == Approx(chosen.critical).epsilon(0.01));
  CHECK(choose_time_step(scene, options, {.rule = TimeStepRule::bound, .fraction = 1}).critical <=
        chosen.critical * (1 + 1e-9));
}

TEST_CASE("held_discs_and_walls_change_the_critical_step") {
  const Assembly assembly = hexagonal_lattice({.columns = 2, .rows = 2, .radius = 0.5});
  const ContactSprings springs(SpringConstants{1, 0});
  Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  const double free = choose_time_step(scene, {}).critical;
  scene.supports = held_still(assembly, std::vector<Support>{{"bottom", 0.0, 0.0, {}}});
  const double held = choose_time_step(scene, {}).critical;
  CHECK(held > free);
  // One disc on two springs 60 degrees apart: omega² = 3 kN/(2 m).
  CHECK(held == Approx(2 / std::sqrt(1.5 / scene.inertia[0].mass)).epsilon(1e-12));
  scene.walls = {{.name = "floor", .point = {0, -0.5}, .normal = {0, 1}, .kN = 2}};
  const TimeStep walled = choose_time_step(scene, {});
  CHECK(walled.critical == Approx(2 / std::sqrt((1.5 + 2) / scene.inertia[0].mass)).epsilon(1e-12));
  CHECK(!walled.exact);
  CHECK(choose_time_step(scene, {}, {.rule = TimeStepRule::bound}).critical <
        2 / std::sqrt(2 / scene.inertia[0].mass) * std::sqrt(2 / 3.5));
}

TEST_CASE("the_rules_of_the_time_step") {
  const Assembly assembly = hexagonal_block(6);
  const ContactSprings springs(SpringConstants{1, 0.05});
  const Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  const TimeStep exact = choose_time_step(scene, {}),
                 bound = choose_time_step(scene, {}, {.rule = TimeStepRule::bound}),
                 thesis = choose_time_step(scene, {}, {.rule = TimeStepRule::thesis, .allow_unstable = true});
  CAPTURE(exact.report(), bound.report(), thesis.report());
  CHECK(exact.exact);
  CHECK(!bound.exact);
  CHECK(bound.step < exact.step);
  CHECK(thesis.step == Approx(std::numbers::pi / 4 * std::sqrt(scene.inertia[0].mass)).epsilon(1e-14));
  CHECK(thesis.critical == exact.critical);
  // A short run is over before the exact step is found.
  const TimeStep brief = choose_time_step(scene, {}, {.duration = 10 * exact.step});
  CHECK(brief.rule == "bound");
  CHECK(brief.step == bound.step);
  CHECK(choose_time_step(scene, {}, {.duration = 1e6 * exact.step}).step == exact.step);
  CHECK(choose_time_step(scene, {.motion = LoopKind::Motion::finite}).report().find("reference state") !=
        std::string::npos);
}

TEST_CASE("steps_that_cannot_work_are_refused_with_the_limit") {
  const Assembly assembly = hexagonal_block(4);
  const ContactSprings springs(SpringConstants{1, 1}), pushing(SpringConstants{1, -0.1});
  const Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  const double critical = choose_time_step(scene, {}).critical;
  const auto refused = [&](const TimeStepOptions& wanted, const SimulationOptions& options = {}) {
    return refusal_of([&] { (void)choose_time_step(scene, options, wanted); });
  };
  CHECK(refused({.step = 1.001 * critical}).says("past the limit"));
  CHECK(refused({.step = 1.001 * critical}).says("1.001 times the critical step"));
  CHECK(refused({.step = 0.999 * critical}).message.empty());
  CHECK(refused({.step = 3 * critical, .allow_unstable = true}).message.empty());
  CHECK(refused({.rule = TimeStepRule::thesis}).says("(thesis) is past the limit"));
  CHECK(refused({.fraction = 1.5}).says("1.5"));
  CHECK(refused({.fraction = 0}).says("> 0 and <= 1"));
  CHECK(refused({.step = -1.0}).says("-1"));
  CHECK(refused({}, {.integrator = Integrator::thesis}).says("no time step is stable"));
  CHECK(refusal_of([] { (void)enum_from<TimeStepRule>("guess"); }).says("\"lanczos\", \"bound\" or \"thesis\""));
  const Scene growing(assembly, pushing, scene.inertia);
  CHECK(refusal_of([&] { (void)choose_time_step(growing, {}); }).says("whatever the step"));
  const TimeStep allowed = choose_time_step(growing, {}, {.allow_unstable = true});
  CAPTURE(allowed.report());
  CHECK(allowed.growth_rate > 0.9 * std::sqrt(2.4 / scene.inertia[0].mass));
  CHECK(allowed.growth_rate < std::sqrt(2.4 / scene.inertia[0].mass));
  Assembly dust = assembly;
  dust.contacts.clear();
  const Scene loose(dust, springs, scene.inertia);
  CHECK(refusal_of([&] { (void)choose_time_step(loose, {}); }).says("nothing vibrates"));
  CHECK(choose_time_step(loose, {}, {.step = 1.0}).ratio() == 0);
}

// A disc that spins alone, six contacts with equal levers r: omega² = 6 kT r²/I. No motion grows faster than all of
// them together.
TEST_CASE("negative_kT_is_found_however_small_it_is") {
  const Assembly assembly = hexagonal_lattice({.columns = 12, .rows = 12, .radius = 0.3});
  const double ratio = GENERATE(1e-1, 1e-3, 1e-5, 1e-8, 1e-13);
  const ContactSprings springs(SpringConstants{1, -ratio});
  Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  const double alone = std::sqrt(12 * ratio / scene.inertia[0].mass);
  const Stopwatch watch;
  const TimeStep allowed = choose_time_step(scene, {}, {.allow_unstable = true});
  CAPTURE(ratio, allowed.growth_rate, alone, watch.seconds());
  CHECK(allowed.growth_rate >= alone * (1 - 1e-12));
  CHECK(allowed.growth_rate <= std::sqrt(2) * alone);
  CHECK(refusal_of([&] { (void)choose_time_step(scene, {}); }).says("whatever the step"));
  scene.supports.resize(1);
  scene.supports[0].group = "all";
  scene.supports[0].rotation = always(0);
  Assembly held = assembly;
  for (std::int32_t d = 0; d < static_cast<std::int32_t>(held.size()); ++d) held.groups["all"].discs.push_back(d);
  Scene still(held, springs, scene.inertia);
  still.supports = scene.supports;
  CHECK(choose_time_step(still, {}, {.allow_unstable = true}).growth_rate < alone);
}

TEST_CASE("mass_damping_never_turns_velocities_around") {
  const Assembly assembly = hexagonal_block(4);
  const ContactSprings springs(SpringConstants{1, 0.4});
  Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  start_with(scene, std::vector<DiscMotion>(assembly.size(), {{1, 0}, 0}));
  const Integrator integrator = GENERATE(Integrator::leapfrog, Integrator::fourth_order);
  const double alpha = GENERATE(0.1, 10.0, 1e4, 1e8);
  SimulationOptions options{.integrator = integrator, .damping = {.mass = alpha}};
  const TimeStep chosen = choose_time_step(scene, options);
  options.time_step = chosen.step;
  Simulation run(scene, options);
  double slower = 1;
  for (int n = 0; n < 20; ++n) {
    run.advance(1);
    const double v = run.velocities()[5].u.x;
    CAPTURE(to_string(integrator), alpha, chosen.report(), n, v, slower);
    REQUIRE(v >= 0);
    REQUIRE(v <= slower);
    slower = v;
  }
  const double least = std::exp(-alpha * 20 * chosen.step);
  CAPTURE(to_string(integrator), alpha, chosen.report(), slower, least);
  CHECK(chosen.step * alpha < 2);
  // It slides to v/alpha; leapfrog is short of it by (alpha h/2)².
  const double half = 0.5 * alpha * chosen.step, slide = (1 - least) / alpha;
  CHECK(run.motions()[5].u.x ==
        Approx(integrator == Integrator::leapfrog && alpha > 1 ? slide * (1 - half * half) : slide).epsilon(0.01));
  const Refusal refused = refusal_of([&] { (void)choose_time_step(scene, options, {.step = 0.9 * chosen.critical}); });
  CHECK(refused.says("turn velocities around") == (0.9 * chosen.critical * alpha > 2));
}

TEST_CASE("magnitudes_whose_squares_are_no_numbers_are_refused_before_a_step") {
  const Assembly assembly = hexagonal_block(4);
  const ContactSprings springs(SpringConstants{1e9, 1e9});
  const Scene scene(assembly, springs, inertia_of(assembly.radii, 1e-318, Body::disc));
  CHECK(refusal_of([&] { (void)choose_time_step(scene, {}); }).says("1e-150"));
}
