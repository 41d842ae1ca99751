// SPDX-License-Identifier: GPL-3.0-or-later
// Impacts of one or two spheres of Chung & Ooi (2011), Granular Matter 13:643, doi 10.1007/s10035-011-0277-0, tests 1
// to 4, against what is exact for them: Hertz's largest overlap, force and duration, the restitution asked for, the
// impulses of gross slip.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>

#include "equidem/core/text.hpp"
#include "equidem/material/inertia.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Material {
  std::string name;
  double young, poisson, density;
};

struct Elastic {
  Material material;
  double radius, speed;  ///< speed of each sphere
  bool wall;
};
std::ostream& operator<<(std::ostream& stream, const Elastic& impact) {
  return stream << impact.material.name;
}

Grain sphere(const Material& material, double radius, Vec2 position, Vec2 velocity) {
  Grain grain;
  grain.position = position;
  grain.velocity = velocity;
  grain.radius = radius;
  grain.inertia = inertia_of(radius, material.density, Body::sphere);
  return grain;
}

/// k of F = k overlap^1.5.
double stiffness_of(const Elastic& impact) {
  const auto& [material, r, speed, wall] = impact;
  if (wall) return hertz_stiffness_on_rigid_wall(material.young, material.poisson, r);
  return hertz_stiffness(material.young, material.poisson, r, material.young, material.poisson, r);
}

ElasticImpact exact(const Elastic& impact) {
  const double mass = inertia_of(impact.radius, impact.material.density, Body::sphere).mass;
  return impact.wall ? hertz_impact(stiffness_of(impact), mass, impact.speed)
                     : hertz_impact(stiffness_of(impact), mass / 2, 2 * impact.speed);
}

/// Duration is known to a step: contacts are counted in steps.
ElasticImpact computed(const Elastic& impact, GrainIntegrator integrator, double step) {
  const auto& [material, r, speed, wall] = impact;
  PairProperties pair;
  pair.stiffness = stiffness_of(impact);
  const double gap = 0.37 * speed * step;
  GrainScene scene;
  if (wall) {
    scene = scene_of({sphere(material, r, {0, r + gap}, {0, -speed})}, {line("wall", {0, 0}, {0, 1})}, pair);
  } else {
    scene = scene_of({sphere(material, r, {-r - gap, 0}, {speed, 0}), sphere(material, r, {r + gap, 0}, {-speed, 0})},
                     {}, pair);
  }
  GrainSimulation simulation(scene, options_of({NormalLaw::hertz_dashpot, integrator}, step));
  ElasticImpact result;
  std::int64_t steps = 0;
  do {
    simulation.advance(1);
    for (const GrainContact& contact : simulation.contacts()) {
      ++steps;
      result.overlap = std::max(result.overlap, contact.overlap);
      result.force = std::max(result.force, contact.normal_force);
    }
  } while (steps == 0 || !simulation.contacts().empty());
  result.duration = static_cast<double>(steps) * step;
  return result;
}

/// Largest error of overlap and force, relative.
double error_of(const Elastic& impact, GrainIntegrator integrator, int steps) {
  const ElasticImpact truth = exact(impact);
  const ElasticImpact result = computed(impact, integrator, truth.duration / steps);
  return std::max(std::abs(result.overlap / truth.overlap - 1), std::abs(result.force / truth.force - 1));
}

const std::vector<Elastic> elastic_impacts{{{"glass pair", 48e9, 0.20, 2800}, 0.01, 10, false},
                                           {{"limestone pair", 20e9, 0.25, 2500}, 0.01, 10, false},
                                           {{"aluminium alloy on a wall", 70e9, 0.30, 2699}, 0.1, 0.2, true},
                                           {{"magnesium alloy on a wall", 40e9, 0.35, 1800}, 0.1, 0.2, true}};

}  // namespace

TEST_CASE("chung_ooi_1_and_2_hertz_spheres_are_pressed_as_deep_and_as_long_as_hertz_says") {
  for (const Elastic& impact : elastic_impacts) {
    const ElasticImpact truth = exact(impact);
    for (const GrainIntegrator integrator : {GrainIntegrator::semi_implicit_euler, GrainIntegrator::velocity_verlet}) {
      const int steps = 2000;
      const ElasticImpact result = computed(impact, integrator, truth.duration / steps);
      CAPTURE(impact, static_cast<int>(integrator), truth.overlap, truth.force, truth.duration,
              result.overlap / truth.overlap - 1, result.force / truth.force - 1, result.duration / truth.duration - 1);
      CHECK(std::abs(result.overlap / truth.overlap - 1) < 1e-3);
      CHECK(std::abs(result.force / truth.force - 1) < 1e-3);
      CHECK(std::abs(result.duration / truth.duration - 1) < 1e-3);
    }
  }
}

TEST_CASE("chung_ooi_1_and_2_errors_fall_with_the_square_of_the_step") {
  // Without a dashpot semi-implicit Euler is velocity Verlet seen half a step later: both are of second order.
  for (const Elastic& impact : elastic_impacts) {
    for (const GrainIntegrator integrator : {GrainIntegrator::semi_implicit_euler, GrainIntegrator::velocity_verlet}) {
      const double coarse = error_of(impact, integrator, 50), fine = error_of(impact, integrator, 800);
      const double order = std::log2(coarse / fine) / 4;
      CAPTURE(impact, static_cast<int>(integrator), coarse, fine, order);
      CHECK(order > 1.8);
    }
  }
}

namespace {

struct Rebound {
  Vec2 velocity;
  double spin = 0;
  double highest = 0;  ///< energy in motion and springs over that before
};

/// A sphere thrown on a rigid wall at 3.9 m/s, the angle from the normal of the wall, with so many steps in a contact.
Rebound rebound(const Material& material, const PairProperties& asked, Stepping stepping, double angle, int steps) {
  constexpr double radius = 0.0025, speed = 3.9;
  const Vec2 velocity = speed * Vec2{std::sin(angle), -std::cos(angle)};
  const double mass = inertia_of(radius, material.density, Body::sphere).mass;
  const Elastic impact{material, radius, -velocity.y, true};
  const ElasticImpact truth = exact(impact);
  PairProperties pair = asked;
  pair.stiffness = stiffness_of(impact);
  if (stepping.law != NormalLaw::hertz_dashpot) {
    const double omega = std::numbers::pi / truth.duration;  // a linear spring of the same duration
    pair.stiffness = mass * omega * omega;
  }
  const double step = truth.duration / steps;
  GrainSimulation simulation(scene_of({sphere(material, radius, {0, radius - 0.41 * velocity.y * step}, velocity)},
                                      {line("wall", {0, 0}, {0, 1})}, pair),
                             options_of(stepping, step));
  const double before = simulation.energy().kinetic;
  Rebound result;
  std::int64_t touched = 0;
  while (touched == 0 || !simulation.contacts().empty()) {
    simulation.advance(1);
    touched = simulation.counters().contacts;
    const EnergyLedger ledger = simulation.energy();
    result.highest =
        std::max(result.highest, (ledger.kinetic + ledger.elastic_normal + ledger.elastic_tangential) / before);
  }
  const Grain after = simulation.grains()[0];
  result.velocity = after.velocity;
  result.spin = after.spin;
  return result;
}

const Material aluminium_oxide{"aluminium oxide", 380e9, 0.23, 4000};
const Material cast_iron{"cast iron", 100e9, 0.25, 7000};
const Material aluminium_alloy{"aluminium alloy", 70e9, 0.33, 2700};

}  // namespace

TEST_CASE("chung_ooi_3_spheres_rebound_with_the_restitution_asked_for") {
  for (const Material& material : {aluminium_oxide, cast_iron}) {
    for (const GrainIntegrator integrator : {GrainIntegrator::semi_implicit_euler, GrainIntegrator::velocity_verlet}) {
      for (const ContactEnd end : {ContactEnd::at_zero_force, ContactEnd::at_zero_overlap}) {
        for (const double e : {0.2, 0.4, 0.6, 0.8, 1.0}) {
          PairProperties pair;
          pair.restitution = e;
          pair.end = end;
          const Stepping stepping{NormalLaw::hertz_dashpot, integrator};
          const double coarse = rebound(material, pair, stepping, 0, 1000).velocity.y / 3.9 - e;
          const double fine = rebound(material, pair, stepping, 0, 16000).velocity.y / 3.9 - e;
          CAPTURE(material.name, stepping.name(), to_string(end), e, coarse, fine, std::log2(coarse / fine) / 4);
          CHECK(std::abs(fine) < 1e-3 * e);
          // the dashpot sees velocities half a step old: first order; an end at zero overlap adds the phase of the last
          // step
          CHECK(std::abs(fine) < std::max(std::abs(coarse) / 10, 1e-9));
        }
      }
    }
  }
}

TEST_CASE("chung_ooi_4_friction_takes_mu_of_the_normal_impulse_where_the_sphere_slides_throughout") {
  constexpr double e = 0.98, mu = 0.092, beta = 0.4, radius = 0.0025;
  PairProperties pair;
  pair.restitution = e;
  pair.friction = mu;
  // laws that give a force need a tangential spring for friction (the next test)
  const std::vector<Stepping> steppings{{NormalLaw::exact_flow, GrainIntegrator::semi_implicit_euler}};
  for (const Material& material : {aluminium_oxide, aluminium_alloy}) {
    for (const Stepping& stepping : steppings) {
      constexpr double tolerance = 1e-12;
      for (int degrees = 5; degrees <= 85; degrees += 5) {
        const double angle = degrees * std::numbers::pi / 180;
        const double normal = 3.9 * std::cos(angle), tangential = 3.9 * std::sin(angle);
        const bool slides = tangential / normal >= mu * (1 + e) * (1 + 1 / beta);
        const Rebound result = rebound(material, pair, stepping, angle, 7);
        // slip throughout, or rolling before the contact ends: v_t/(1 + beta)
        const double left = slides ? tangential - mu * (1 + e) * normal : tangential / (1 + beta);
        const double spin = -(tangential - left) / (beta * radius);
        CAPTURE(material.name, stepping.name(), degrees, slides, result.velocity.x / left - 1,
                result.velocity.y / (e * normal) - 1, result.spin / spin - 1, result.highest - 1);
        CHECK(std::abs(result.velocity.y / (e * normal) - 1) < tolerance);
        CHECK(std::abs(result.velocity.x / left - 1) < tolerance);
        CHECK(std::abs(result.spin / spin - 1) < tolerance);
        CHECK(result.highest < 1 + 1e-4);
      }
    }
  }
}

TEST_CASE("chung_ooi_4_a_tangential_spring_changes_nothing_where_the_sphere_slides_and_gains_nothing_where_it_sticks") {
  constexpr double e = 0.98, mu = 0.092, beta = 0.4;
  PairProperties pair;
  pair.restitution = e;
  pair.friction = mu;
  for (const GrainIntegrator integrator : {GrainIntegrator::semi_implicit_euler, GrainIntegrator::velocity_verlet}) {
    for (const Material& material : {aluminium_oxide, aluminium_alloy}) {
      for (int degrees = 5; degrees <= 85; degrees += 5) {
        const double angle = degrees * std::numbers::pi / 180;
        const double normal = 3.9 * std::cos(angle), tangential = 3.9 * std::sin(angle);
        const Elastic impact{material, 0.0025, normal, true};
        // kT/kN of Mindlin at half the largest overlap; kN = 1.5 k overlap^0.5, kT = ratio k d_c^0.5, d_c the diameter
        pair.tangential_ratio = 2 * (1 - material.poisson) / (2 - material.poisson) * 1.5 *
                                std::sqrt(0.5 * exact(impact).overlap / (2 * impact.radius));
        const Rebound result = rebound(material, pair, {NormalLaw::hertz_dashpot, integrator}, angle, 2000);
        const double limit = mu * (1 + e) * (1 + 1 / beta), slope = tangential / normal;
        const double slipped = tangential - mu * (1 + e) * normal;
        CAPTURE(material.name, static_cast<int>(integrator), degrees, result.velocity.x / slipped - 1,
                result.highest - 1);
        CHECK(result.highest < 1 + 1e-4);
        // far enough above the limit slip lasts until the spring is gone
        if (slope > 1.5 * limit) CHECK(std::abs(result.velocity.x / slipped - 1) < 1e-3);
      }
    }
  }
}
