// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "grains/bonded_scenes.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

using Partners = std::vector<std::multiset<std::int32_t>>;
Partners partners_of(const std::vector<BodyContact>& contacts, std::size_t bodies) {
  Partners partners(bodies);
  for (const BodyContact& c : contacts) {
    partners[static_cast<std::size_t>(c.i)].insert(c.j);
    if (c.j >= 0) partners[static_cast<std::size_t>(c.j)].insert(c.i);
  }
  return partners;
}

/// Forces and moments of contacts on each body, and the largest that is missing in what a step changed.
struct Sums {
  std::vector<Vec2> forces;
  std::vector<double> moments;
  double largest = 0, off = 0, off_moment = 0;  ///< N, N, N m
  std::size_t compared = 0;

  /// \param places of the bodies at which the arms are given
  void add(const std::vector<BodyContact>& contacts, const std::vector<Grain>& places) {
    forces.assign(places.size(), {});
    moments.assign(places.size(), 0);
    for (const BodyContact& c : contacts) {
      const auto i = static_cast<std::size_t>(c.i), j = static_cast<std::size_t>(c.j);
      forces[i] += c.force;
      moments[i] += cross(c.arm, c.force);
      if (c.j < 0) continue;
      forces[j] -= c.force;
      moments[j] -= cross(places[i].position + c.arm - places[j].position, c.force);
    }
  }
  void compare(std::size_t g, const Grain& before, const Grain& after, double dt, Vec2 gravity) {
    ++compared;
    const Vec2 force = before.inertia.mass * ((after.velocity - before.velocity) / dt - gravity);
    largest = std::max(largest, norm(force));
    off = std::max(off, norm(force - forces[g]));
    off_moment = std::max(off_moment, std::abs(before.inertia.moment * (after.spin - before.spin) / dt - moments[g]));
  }
};

}  // namespace

// A contact that ended within the step is not listed, but it pushed: only bodies that kept their contacts are compared.
TEST_CASE("contact_forces_of_a_step_add_up_to_what_it_changed") {
  const bool shapes = GENERATE(false, true);
  const NormalLaw law = GENERATE(NormalLaw::exact_flow, NormalLaw::linear_dashpot, NormalLaw::hertz_dashpot);
  if (shapes && law != NormalLaw::linear_dashpot) return;
  const GrainScene scene = shapes ? mixed_box(law, 6, 6, 7) : busy_box(law, 6, 6, 7);
  const double dt = 2e-3;
  GrainSimulation simulation(scene, options_of(law, dt));
  Sums sums;
  std::ptrdiff_t walls = 0;
  for (int sample = 0; sample < 60; ++sample) {
    simulation.advance(40);
    const std::vector<Grain> before = simulation.grains();
    const Partners had = partners_of(simulation.body_contacts(), before.size());
    simulation.advance(1);
    const std::vector<Grain> after = simulation.grains();
    const std::vector<BodyContact> contacts = simulation.body_contacts();
    const Partners have = partners_of(contacts, before.size());
    walls += std::ranges::count_if(contacts, [](const BodyContact& c) { return c.j < 0; });
    sums.add(contacts, before);
    for (std::size_t g = 0; g < before.size(); ++g)
      if (had[g] == have[g] && !have[g].empty()) sums.compare(g, before[g], after[g], dt, scene.gravity);
  }
  CAPTURE(shapes, to_string(law), sums.compared, walls, sums.largest, sums.off, sums.off_moment);
  CHECK(sums.compared > 100);
  CHECK(walls > 50);
  CHECK(sums.off <= 1e-9 * sums.largest);
  // exact_flow: the force acts along the mean normal of the step, the levers are those at its start.
  CHECK(sums.off_moment <= (law == NormalLaw::exact_flow ? 2e-3 : 1e-9) * sums.largest);
}

// As of bonded discs (tests/dynamics/bonded_contacts.cpp), of which the same struct tells.
TEST_CASE("normal_force_is_positive_in_tension_and_tangential_force_acts_on_the_first_body") {
  GrainSimulation simulation(busy_box(NormalLaw::linear_dashpot, 4, 3, 3), options_of(NormalLaw::linear_dashpot, 1e-3));
  std::size_t pressed = 0;
  for (int sample = 0; sample < 20; ++sample) {
    simulation.advance(40);
    const std::vector<Grain> grains = simulation.grains();
    for (const BodyContact& c : simulation.body_contacts()) {
      if (grains[static_cast<std::size_t>(c.i)].shape() != GrainShape::disc) continue;
      const Vec2 normal = c.arm / norm(c.arm);
      CHECK(std::abs(dot(normal, c.force) - c.normal_force) <= 1e-9 * norm(c.force));
      CHECK(std::abs(cross(normal, c.force) - c.tangential_force) <= 1e-9 * norm(c.force));
      pressed += c.normal_force < 0 ? 1 : 0;
      CHECK(c.normal_force <= 0);
    }
  }
  CHECK(pressed > 20);
}

TEST_CASE("forces_of_bonds_are_contacts_and_add_up_to_what_a_step_changed") {
  const double dt = 1e-4;
  GrainBond like = all_of_a_bond;
  like.rolling_dashpot = GENERATE(0.0, 0.1);
  const GrainScene scene = chain_scene(NormalLaw::linear_dashpot, 8, like);
  GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, dt));
  simulation.advance(1000);
  const std::vector<Grain> before = simulation.grains();
  simulation.advance(1);
  const std::vector<Grain> after = simulation.grains();
  const std::vector<BodyContact> contacts = simulation.body_contacts();
  CHECK(contacts.size() == scene.bonds.size());
  for (const BodyContact& c : contacts) {
    CHECK(c.j == c.i + 1);
    const Vec2 branch = after[c.j].position - after[c.i].position, normal = branch / norm(branch);
    CHECK(norm(c.normal_force * normal + c.tangential_force * perpendicular(normal) - c.force) < 1e-12 * norm(c.force));
  }
  Sums sums;
  sums.add(contacts, after);
  for (std::size_t g = 0; g < before.size(); ++g) sums.compare(g, before[g], after[g], dt, {});
  CAPTURE(sums.largest, sums.off, sums.off_moment);
  CHECK(sums.off < 1e-3 * sums.largest);  // springs and directions are those after the step
  if (like.rolling_dashpot == 0) CHECK(sums.off_moment < 1e-3 * sums.largest);
}
