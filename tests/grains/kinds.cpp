// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts, kinds and time steps from options, without a case file.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/pair_options.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double density = 2500;

Grain dense_sphere(Vec2 position, double radius, Vec2 velocity = {}) {
  return {.position = position,
          .radius = radius,
          .inertia = inertia_of(radius, density, Body::sphere),
          .velocity = velocity};
}

/// Two balls that fly at each other, and one above a floor.
GrainScene three_balls() {
  GrainScene scene;
  scene.grains = {dense_sphere({0, 1}, 0.01, {1, 0}), dense_sphere({0.0301, 1}, 0.02, {-1, 0}),
                  dense_sphere({1, 0.5}, 0.03)};
  Wall floor;
  floor.name = "floor";
  floor.normal = {0, 1};
  scene.walls = {floor};
  return scene;
}

PairOptions contact(StiffnessOptions stiffness, double restitution = 0.8) {
  return {.stiffness = stiffness, .rebound = Restitution{restitution}};
}

std::string option_at_fault(const CollisionOptions& options, NormalLaw law = NormalLaw::linear_dashpot) {
  GrainScene scene = three_balls();
  const Refusal refusal = refusal_of([&] { set_kinds(scene, {}, options, law); });
  return refusal.message.empty() ? "none" : refusal.where;
}

}  // namespace

TEST_CASE("bodies_from_options_rebound_as_asked") {
  const StiffnessOptions stiffness =
      GENERATE(StiffnessOptions{SpringStiffness{1e5}}, StiffnessOptions{ContactDuration{1e-4}},
               StiffnessOptions{LargestOverlap{1e-4}});
  const NormalLaw law = GENERATE(NormalLaw::linear_dashpot, NormalLaw::exact_flow, NormalLaw::energy_map);
  const double e = 0.8;
  GrainScene scene = three_balls();
  CollisionOptions collisions{.body = Body::sphere, .bodies = contact(stiffness, e)};
  collisions.bodies.closing_speed = 2;
  const ContactTable contacts = set_kinds(scene, {}, collisions, law);
  CHECK(contacts.kinds == std::vector<std::string>{"grains", "walls"});
  GrainOptions options{.law = law};
  const GrainTimeStep step = choose_time_step(scene, contacts, options, {.steps_per_contact = 200});
  options.time_step = step.step;
  scene.pairs = pairs_at(contacts, law, step.step);
  GrainSimulation simulation(scene, options);
  simulation.advance(count_steps(0.01, step.step));
  const auto grains = simulation.grains();
  CAPTURE(to_string(law), stiffness.index(), step.step, step.contact, step.between);
  CHECK(grains[1].velocity.x - grains[0].velocity.x == Approx(2 * e).epsilon(0.01));
}

TEST_CASE("a_contact_lasts_as_long_as_its_options_say") {
  for (const double e : {1.0, 0.8, 0.3}) {
    const PairContact made = contact_of(contact(ContactDuration{2e-4}, e), NormalLaw::linear_dashpot, {});
    for (const double step : {1e-5, 3e-6}) {
      const PairProperties pair = properties_at(made, NormalLaw::linear_dashpot, step);
      const double zeta = damping_ratio(NormalLaw::linear_dashpot, pair);
      CAPTURE(e, step, zeta, pair.dimensionless);
      // the half period of the damped oscillator
      CHECK(std::numbers::pi * step / std::sqrt(pair.dimensionless * (1 - zeta * zeta)) == Approx(2e-4));
    }
  }
}

TEST_CASE("errors_of_contacts_name_the_option_at_fault") {
  const PairOptions good = contact(SpringStiffness{1e5});
  CHECK(option_at_fault({.bodies = good}) == "none");
  CHECK(option_at_fault({}) == "restitution");
  CHECK(option_at_fault({.bodies = {.rebound = Restitution{0.5}}}) == "stiffness");
  CHECK(option_at_fault({.bodies = good, .walls = contact(LargestOverlap{1e-4})}) == "walls.largest_overlap");
  CHECK(option_at_fault({.bodies = good, .pairs = {{"grains", "flor", good}}}) == "pairs.0.with");
  CHECK(option_at_fault({.bodies = good, .pairs = {{"floor", "grains", good}}}) == "pairs.0.group");
  CHECK(option_at_fault({.bodies = good, .pairs = {{"grains", "floor", good}, {"grains", "floor", good}}}) ==
        "pairs.1");
  CHECK(option_at_fault({.bodies = good, .pairs = {{"grains", "floor", contact(SpringStiffness{1e5}, 0)}}}) ==
        "pairs.0.restitution");
  CHECK(option_at_fault({.bodies = contact(ContactDuration{1e-4})}, NormalLaw::hertz_dashpot) == "contact_duration");
  CHECK(option_at_fault({.bodies = contact(HertzModuli{1e9, 0.3})}, NormalLaw::hertz_dashpot) == "young_modulus");
  CHECK(option_at_fault({.body = Body::sphere, .bodies = contact(WaveSpeedStiffness{density, 150, 0.25})}) ==
        "shear_wave_speed");
  CHECK(option_at_fault({.bodies = contact(WaveSpeedStiffness{density, 150, 0.5})}) == "poisson_ratio");
  PairOptions damped = good;
  damped.rebound = DashpotDamping{0.3};
  CHECK(option_at_fault({.bodies = damped}) == "none");
  CHECK(option_at_fault({.bodies = damped}, NormalLaw::energy_map) == "damping");
}

TEST_CASE("a_step_that_cannot_be_chosen_is_asked_for") {
  const auto place_of_error = [](StiffnessOptions stiffness, NormalLaw law, const GrainStepOptions& wanted = {}) {
    GrainScene scene = three_balls();
    const ContactTable contacts = set_kinds(scene, {}, {.body = Body::sphere, .bodies = contact(stiffness)}, law);
    const Refusal refusal = refusal_of([&] { choose_time_step(scene, contacts, {.law = law}, wanted); });
    return refusal.message.empty() ? "none" : refusal.where;
  };
  CHECK(place_of_error(SpringStiffness{1e5}, NormalLaw::linear_dashpot) == "none");
  CHECK(place_of_error(SpringStiffness{1e5}, NormalLaw::linear_dashpot, {.time_step = 1}) == "time_step");
  CHECK(place_of_error(SpringStiffness{1e5}, NormalLaw::hertz_dashpot) == "time_step");
  CHECK(place_of_error(DimensionlessStiffness{0.1}, NormalLaw::energy_map) == "time_step");
  CHECK_THROWS_AS(count_steps(1, 1e-20), Error);
}

TEST_CASE("reduced_masses_span_all_pairs_of_two_kinds") {
  std::vector<Grain> grains;
  const std::vector<double> masses{5, 2, 7, 3, 11};
  const std::vector<int> kinds{0, 0, 1, 0, 1};
  for (std::size_t g = 0; g < masses.size(); ++g) {
    Grain grain;
    grain.inertia.mass = masses[g];
    grain.kind = kinds[g];
    grains.push_back(grain);
  }
  const auto of_kinds = masses_of_kinds(grains, 3);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      double smallest = INFINITY, largest = 0;
      for (std::size_t i = 0; i < masses.size(); ++i) {
        if (kinds[i] == a && b == 2) smallest = std::min(smallest, masses[i]), largest = std::max(largest, masses[i]);
        if (kinds[i] == b && a == 2) smallest = std::min(smallest, masses[i]), largest = std::max(largest, masses[i]);
        for (std::size_t j = 0; j < masses.size(); ++j) {
          if (i == j || kinds[i] != a || kinds[j] != b) continue;
          const double reduced = masses[i] * masses[j] / (masses[i] + masses[j]);
          smallest = std::min(smallest, reduced), largest = std::max(largest, reduced);
        }
      }
      CAPTURE(a, b);
      const auto found = reduced_masses(of_kinds, a, b);
      REQUIRE(found.has_value() == (largest > 0));
      if (!found) continue;
      CHECK(found->smallest == Approx(smallest));
      CHECK(found->largest == Approx(largest));
    }
  }
}
