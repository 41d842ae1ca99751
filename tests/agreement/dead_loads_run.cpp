// SPDX-License-Identifier: GPL-3.0-or-later
// Dead loads on discs without bonds beside motion in which they grow slowly.
#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/core/text.hpp"

#include "agreement/slow_grains.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Statics: gravity is put on as a dead load, then the lid moves.
Unbonded under_gravity(const HeldDiscs& held, const Push& push) {
  LoadPathOptions path;
  constexpr double hardly = 1e-13;  // m: something has to grow with lambda
  path.supports = {{"walls", 0, 0, 0}, {"lid", push.lid.x + hardly, push.lid.y, 0}};
  if (held.assembly.groups.at("lid").discs.empty()) path.supports = {{"walls", 0, hardly, 0}};
  path.control = LoadControl::motion;
  path.legs = {1};
  for (std::size_t k = 0; k < held.masses.size(); ++k)
    path.dead_loads.push_back({fmt::format("disc {}", k), LoadKind::per_disc, held.masses[k] * push.gravity, 0});
  return {held.assembly, ContactSprings(frictional_springs), held.strengths, path, held.options};
}

/// The largest difference of a force over the largest force.
double difference_of_forces(const HeldDiscs& held, Unbonded& statics, const SlowGrains::Forces& moved) {
  double difference = 0, largest = 0;
  for (std::size_t c = 0; c < held.bodies.size(); ++c) {
    const auto found = moved.find(held.bodies[c]);
    const ContactForce f = statics.run().contact_state().forces()[c],
                       g = found == moved.end() ? ContactForce{} : found->second;
    largest = std::max({largest, std::abs(f.normal), std::abs(f.tangential)});
    difference = std::max({difference, std::abs(f.normal - g.normal), std::abs(f.tangential - g.tangential)});
  }
  return difference / largest;
}

double farthest(const std::vector<Grain>& from, const std::vector<Grain>& to) {
  double most = 0;
  for (std::size_t k = 0; k < from.size(); ++k) most = std::max(most, norm(to[k].position - from[k].position));
  return most;
}

/// Two discs that fill the width of a box, and one in the groove between them.
struct Pile {
  static constexpr double r = 0.01;
  Vec2 box{4 * r, 10 * r};
  std::vector<Grain> discs;

  Pile() {
    for (const Vec2& at : {Vec2{r, r}, Vec2{3 * r, r}, Vec2{2 * r, r + std::sqrt(3.0) * r}})
      discs.push_back({.position = at, .radius = r, .inertia = inertia_of(r, frictional_density, Body::disc)});
  }
};

}  // namespace

// Friction depends on the way: first the weight of the discs turns and grows, then the lid shears them. Differences
// fall with the speed, to 8e-4 at a quarter of it; those of the other order stay, at 7e-3.
TEST_CASE("discs_under_a_dead_weight_that_are_sheared_then_carry_the_forces_of_slow_motion") {
  constexpr double overlap = 1e-5, way = 0.004 * overlap;
  Vec2 box;
  const std::vector<Grain> discs = jammed_discs(100, overlap, box);
  SlowGrains slow(discs, box, {}, 8000);
  slow.push_to({{way, -way}, {}});
  const HeldDiscs held = held_discs(slow.packing(), 20 * overlap, {});
  const Push weight{{}, {2.5, -0.75}}, shear{{-2 * way, -0.3 * way}, {}};
  Unbonded statics = under_gravity(held, weight + shear);
  statics.all();
  const Push rest = slow.at();
  slow.push_to(rest + weight);
  slow.push_to(rest + weight + shear);
  const double difference = difference_of_forces(held, statics, slow.forces());
  CAPTURE(difference, statics.run().why(), statics.events().size());
  CHECK(statics.run().end() == PathEnd::legs_done);
  CHECK(statics.run().contact_state().dead() == 1);
  CHECK(difference < 0.004);
  // The other order leads elsewhere.
  SlowGrains other(discs, box, {}, 8000);
  other.push_to({{way, -way}, {}});
  other.push_to(rest + shear);
  other.push_to(rest + weight + shear);
  const double in_other_order = difference_of_forces(held, statics, other.forces());
  CAPTURE(in_other_order);
  CHECK(in_other_order > 2 * difference);
}

// A weight that turns points at the lower contact of the upper disc where its tangent is that of 30 degrees.
TEST_CASE("a_disc_on_two_others_leaves_them_in_motion_at_the_share_of_the_dead_loads_at_which_statics_ends") {
  const Pile pile;
  const double g = 10, across = 10;
  SlowGrains slow(pile.discs, pile.box, {}, 8000);
  slow.push_to({{}, {0, -g}});
  const HeldDiscs held = held_discs(slow.packing(), 1e-3, {});
  Unbonded statics = under_gravity(held, {{}, {across, 0}});
  statics.all();
  const double share = statics.run().contact_state().dead();
  CAPTURE(share, statics.run().why(), statics.events().size());
  CHECK(statics.run().end() == PathEnd::load_moves_part);
  CHECK(share == Approx(g * std::tan(std::acos(-1.0) / 6) / across).epsilon(1e-3));
  const Push rest = slow.at();
  const auto turned = [&](double part) { return rest + Push{{}, {part * share * across, 0}}; };
  slow.push_to(turned(0.97));
  Unbonded below = under_gravity(held, {{}, {0.97 * share * across, 0}});
  below.all();
  CHECK(below.run().end() == PathEnd::legs_done);
  const double difference = difference_of_forces(held, below, slow.forces());
  CAPTURE(difference);
  CHECK(difference < 0.003);
  CHECK(farthest(pile.discs, slow.grains()) < 1e-3 * Pile::r);
  for (int k = 0; k < 30; ++k) slow.push_to(turned(1.03));
  CHECK(farthest(pile.discs, slow.grains()) > 0.05 * Pile::r);
}
