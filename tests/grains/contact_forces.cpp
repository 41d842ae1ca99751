// SPDX-License-Identifier: GPL-3.0-or-later
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

}  // namespace

// A contact that ended within the step is not listed, but it pushed: only bodies that kept their contacts are compared.
TEST_CASE("contact_forces_of_a_step_add_up_to_what_it_changed") {
  const bool shapes = GENERATE(false, true);
  const NormalLaw law = GENERATE(NormalLaw::exact_flow, NormalLaw::linear_dashpot, NormalLaw::hertz_dashpot);
  if (shapes && law != NormalLaw::linear_dashpot) return;
  CAPTURE(shapes, to_string(law));
  const GrainScene scene = shapes ? mixed_box(law, 6, 6, 7) : busy_box(law, 6, 6, 7);
  const double dt = 2e-3;
  GrainSimulation simulation(scene, options_of(law, dt));
  double worst = 0, worst_moment = 0, largest = 0;
  std::size_t compared = 0, walls = 0;
  for (int sample = 0; sample < 60; ++sample) {
    simulation.advance(40);
    const std::vector<Grain> before = simulation.grains();
    const Partners had = partners_of(simulation.body_contacts(), before.size());
    simulation.advance(1);
    const std::vector<Grain> after = simulation.grains();
    const std::vector<BodyContact> contacts = simulation.body_contacts();
    const Partners have = partners_of(contacts, before.size());
    std::vector<Vec2> sums(before.size());
    std::vector<double> moments(before.size());
    for (const BodyContact& c : contacts) {
      const auto i = static_cast<std::size_t>(c.i);
      sums[i] += c.force;
      moments[i] += cross(c.arm, c.force);
      walls += c.j < 0 ? 1 : 0;
      if (c.j < 0) continue;
      const auto j = static_cast<std::size_t>(c.j);
      sums[j] -= c.force;
      moments[j] -= cross(before[i].position + c.arm - before[j].position, c.force);
    }
    for (std::size_t g = 0; g < before.size(); ++g) {
      if (had[g] != have[g] || have[g].empty()) continue;
      ++compared;
      const Grain& body = before[g];
      const Vec2 push = body.inertia.mass * ((after[g].velocity - body.velocity) / dt - scene.gravity);
      largest = std::max(largest, norm(push));
      worst = std::max(worst, norm(push - sums[g]));
      worst_moment =
          std::max(worst_moment, std::abs(body.inertia.moment * (after[g].spin - body.spin) / dt - moments[g]));
    }
  }
  CAPTURE(compared, walls, largest);
  CHECK(compared > 100);
  CHECK(walls > 50);
  CHECK(worst <= 1e-9 * largest);
  // exact_flow: the force acts along the mean normal of the step, the levers are those at its start.
  CHECK(worst_moment <= (law == NormalLaw::exact_flow ? 2e-3 : 1e-9) * largest);
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
  std::vector<Vec2> sums(before.size());
  std::vector<double> moments(before.size());
  std::size_t bonds = 0;
  for (const BodyContact& c : simulation.body_contacts()) {
    const auto i = static_cast<std::size_t>(c.i), j = static_cast<std::size_t>(c.j);
    bonds += j == i + 1 ? 1 : 0;
    const Vec2 normal = (after[j].position - after[i].position) / norm(after[j].position - after[i].position);
    CHECK(norm(c.normal_force * normal + c.tangential_force * perpendicular(normal) - c.force) < 1e-12 * norm(c.force));
    sums[i] += c.force;
    sums[j] -= c.force;
    moments[i] += cross(c.arm, c.force);
    moments[j] -= cross(after[i].position + c.arm - after[j].position, c.force);
  }
  CHECK(bonds == scene.bonds.size());
  double worst = 0, worst_moment = 0, largest = 0;
  for (std::size_t g = 0; g < before.size(); ++g) {
    const Vec2 push = before[g].inertia.mass / dt * (after[g].velocity - before[g].velocity);
    largest = std::max(largest, norm(push));
    worst = std::max(worst, norm(push - sums[g]));
    worst_moment =
        std::max(worst_moment, std::abs(before[g].inertia.moment * (after[g].spin - before[g].spin) / dt - moments[g]));
  }
  CAPTURE(largest, worst, worst_moment);
  CHECK(worst < 1e-3 * largest);  // springs and directions are those after the step
  if (like.rolling_dashpot == 0) CHECK(worst_moment < 1e-3 * largest);
}
