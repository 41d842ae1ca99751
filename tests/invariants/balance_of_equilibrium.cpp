// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Laws that every equilibrium obeys, whichever solver found it: forces and moments balance, energy is work, load cases
/// are reciprocal and superpose.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/statics/motion_description.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

LoadCase random_loads(const HeldScene& scene, bool moments, std::uint64_t seed) {
  Random random(seed);
  LoadCase loads;
  for (const char* group : {"a", "b"}) {
    Load load{.group = group, .kind = LoadKind::per_disc, .force = {}, .moment = 0};
    load.force = {random.uniform(-1e5, 1e5), random.uniform(-1e5, 1e5)};
    if (moments) load.moment = scene.assembly().mean_radius() * random.uniform(-1e5, 1e5);
    loads.push_back(load);
  }
  return loads;
}

double work(const Assembly& assembly, const LoadCase& loads, const Equilibrium& state) {
  double sum = 0;
  for (const Load& load : loads) {
    for (const std::int32_t d : group(assembly, load.group).discs) {
      sum += dot(load.force, state.motions[d].u) + load.moment * state.motions[d].theta;
    }
  }
  return sum;
}

/// Sum of |F| |u| over the loads: what the terms of a work can cancel from.
double work_scale(const Assembly& assembly, const LoadCase& loads, const Equilibrium& state) {
  double sum = 0;
  for (const Load& load : loads) {
    for (const std::int32_t d : group(assembly, load.group).discs) {
      sum += norm(load.force) * norm(state.motions[d].u) + std::abs(load.moment * state.motions[d].theta);
    }
  }
  return sum;
}

bool turns(const HeldScene& scene) {
  return derive_effects(scene.springs, scene.options.rotation).rotation;
}

/// Sum of all forces on the body, and of their moments about the origin.
struct Balance {
  Vec2 force;
  double moment = 0, sum_of_forces = 0, sum_of_moments = 0;

  void add(Vec2 at, Vec2 f, double m) {
    force += f;
    moment += cross(at, f) + m;
    sum_of_forces += norm(f);
    sum_of_moments += norm(at) * norm(f) + std::abs(m);
  }
};

Balance balance_of(const Assembly& assembly, const LoadCase& loads, const Equilibrium& state) {
  Balance balance;
  for (const Load& load : loads) {
    for (const std::int32_t d : group(assembly, load.group).discs) {
      balance.add(assembly.centres[d], load.force, load.moment);
    }
  }
  for (const Reaction& r : state.reactions) balance.add(assembly.centres[r.disc], r.force, r.moment);
  for (const double moment : state.rotation_moments) balance.add({}, {}, moment);
  return balance;
}

}  // namespace

TEST_CASE("every_scene_is_solved_to_a_residual_of_1e_13") {
  for (const HeldScene& scene : held_scenes()) {
    const Equilibrium state = solve_equilibrium(scene.assembly(), scene.springs, scene.supports,
                                                random_loads(scene, turns(scene), 1), scene.options);
    CAPTURE(scene.name, state.relative_residual, state.report());
    CHECK(state.relative_residual <= 1e-13);
  }
}

TEST_CASE("reactions_balance_loads_and_moments") {
  for (const HeldScene& scene : held_scenes()) {
    const LoadCase loads = random_loads(scene, turns(scene), 2);
    const Equilibrium state = solve_equilibrium(scene.assembly(), scene.springs, scene.supports, loads, scene.options);
    const Balance balance = balance_of(scene.assembly(), loads, state);
    CAPTURE(scene.name, balance.force.x, balance.force.y, balance.sum_of_forces, balance.moment,
            balance.sum_of_moments);
    CHECK(norm(balance.force) <= 1e-12 * balance.sum_of_forces);
    // Contacts through the period pull on an image: moments about a point balance only with free boundaries.
    if (!scene.assembly().periodic()) CHECK(std::abs(balance.moment) <= 1e-12 * balance.sum_of_moments);
  }
}

TEST_CASE("energy_is_half_the_work_of_the_loads") {
  for (const HeldScene& scene : held_scenes()) {
    const LoadCase loads = random_loads(scene, turns(scene), 3);
    const Equilibrium state = solve_equilibrium(scene.assembly(), scene.springs, scene.supports, loads, scene.options);
    const double half_work = 0.5 * work(scene.assembly(), loads, state);
    const double scale = work_scale(scene.assembly(), loads, state);
    const double by_motions = elastic_energy(scene.assembly(), scene.springs, state.motions);
    CAPTURE(scene.name, state.energy, half_work, scale, by_motions);
    CHECK(std::abs(state.energy - half_work) <= 1e-12 * scale);
    CHECK(std::abs(state.energy - by_motions) <= 1e-9 * scale);
    if (scene.springs.any_negative()) continue;
    CHECK(state.energy >= 0);
  }
}

TEST_CASE("two_load_cases_do_the_same_work_on_one_anothers_motions") {  // Betti
  for (const HeldScene& scene : held_scenes()) {
    EquilibriumSolver solver(scene.assembly(), scene.springs, scene.supports, scene.options);
    const LoadCase first = random_loads(scene, turns(scene), 4), second = random_loads(scene, turns(scene), 5);
    const Equilibrium of_first = solver.solve(first), of_second = solver.solve(second);
    const double there = work(scene.assembly(), first, of_second), back = work(scene.assembly(), second, of_first);
    const double scale =
        work_scale(scene.assembly(), first, of_second) + work_scale(scene.assembly(), second, of_first);
    CAPTURE(scene.name, there, back, scale);
    CHECK(std::abs(there - back) <= 1e-12 * scale);
  }
}

TEST_CASE("load_cases_superpose") {
  for (const HeldScene& scene : held_scenes()) {
    EquilibriumSolver solver(scene.assembly(), scene.springs, scene.supports, scene.options);
    const LoadCase first = random_loads(scene, turns(scene), 6), second = random_loads(scene, turns(scene), 7);
    LoadCase both = first;
    for (Load load : second) {
      load.force *= -2;
      load.moment *= -2;
      both.push_back(load);
    }
    const Equilibrium p = solver.solve(first), q = solver.solve(second), sum = solver.solve(both);
    double motion = 0, difference = 0, force = 0, force_difference = 0;
    for (std::size_t d = 0; d < sum.motions.size(); ++d) {
      motion = std::max({motion, norm(p.motions[d].u), norm(q.motions[d].u)});
      difference = std::max(difference, norm(p.motions[d].u - 2 * q.motions[d].u - sum.motions[d].u));
    }
    for (std::size_t c = 0; c < sum.contact_forces.size(); ++c) {
      const ContactForce &f = p.contact_forces[c], &g = q.contact_forces[c], &s = sum.contact_forces[c];
      force = std::max({force, std::abs(f.normal), std::abs(g.normal), std::abs(f.tangential), std::abs(g.tangential)});
      force_difference = std::max({force_difference, std::abs(f.normal - 2 * g.normal - s.normal),
                                   std::abs(f.tangential - 2 * g.tangential - s.tangential)});
    }
    CAPTURE(scene.name, motion, difference, force, force_difference);
    CHECK(difference <= 1e-11 * motion);
    CHECK(force_difference <= 1e-11 * force);
  }
}
