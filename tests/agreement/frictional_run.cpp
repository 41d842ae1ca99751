// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts that open, close and slip along a path carry the forces of damped motion that is loaded slowly.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/lattices/hexagonal.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/breakage/unbonded/unbonded_run.hpp"
#include "equidem/core/text.hpp"

#include "agreement/slow_grains.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Statics beside motion at one level.
struct FrictionalLevel {
  double force = 0;  // the largest difference of a force over the largest force
  std::int64_t open = 0;
  std::vector<std::string> other_contacts;  // open in one and closed in the other
  std::map<std::string, int> events;
  PathEnd ended = PathEnd::none;
  std::string why;
};

FrictionalLevel level_of(const HeldDiscs& held, const Push& load, const std::vector<double>& legs,
                         const SlowGrains::Forces& moved) {
  LoadPathOptions path;
  path.supports = {{"walls", 0, 0, 0}, {"lid", load.lid.x, load.lid.y, 0}};
  path.control = load.lid == Vec2{} ? LoadControl::load : LoadControl::motion;
  path.legs = legs;
  for (std::size_t k = 0; load.gravity != Vec2{} && k < held.masses.size(); ++k)
    path.loads.push_back({fmt::format("disc {}", k), LoadKind::per_disc, held.masses[k] * load.gravity, 0});
  Unbonded scene(held.assembly, ContactSprings(frictional_springs), held.strengths, path, held.options);
  scene.all();
  FrictionalLevel level;
  level.ended = scene.run().end();
  level.why = scene.run().why();
  for (const BreakEvent& event : scene.events()) ++level.events[to_string(event.mode)];
  const UnbondedState& state = scene.run().contact_state();
  double largest = 0;
  for (const ContactForce& f : state.forces())
    largest = std::max({largest, std::abs(f.normal), std::abs(f.tangential)});
  for (std::size_t c = 0; c < held.bodies.size(); ++c) {
    const auto found = moved.find(held.bodies[c]);
    const ContactForce f = state.forces()[c], g = found == moved.end() ? ContactForce{} : found->second;
    level.force = std::max(
        {level.force, std::abs(f.normal - g.normal) / largest, std::abs(f.tangential - g.tangential) / largest});
    const bool open = state.status()[c] == ContactStatus::open;
    level.open += open ? 1 : 0;
    // A contact that just touches carries no force that tells whether it is open.
    const bool touches = std::abs(state.normal_coordinate(c)) < 1e-4 * largest;
    if (open != (found == moved.end()) && !touches && state.status()[c] != ContactStatus::bonded)
      level.other_contacts.push_back(
          fmt::format("{} {}: {} beside {}", held.bodies[c].first, held.bodies[c].second, f.normal, g.normal));
  }
  return level;
}

/// A block of bonded discs between floor and lid with a crack across it, whose faces lie `gap` apart.
struct CrackedBlock {
  std::vector<Grain> discs;
  std::vector<GrainBond> bonds;
  Vec2 box;

  explicit CrackedBlock(double gap) {
    constexpr double r = 0.01;
    const Assembly lattice = hexagonal_lattice({.columns = 7, .rows = 8, .radius = r});
    const Vec2 low = *std::ranges::min_element(lattice.centres, {}, &Vec2::y);
    const std::vector<Notch> crack{{{3.1 * r, 4.2 * r}, {11.2 * r, 9.3 * r}}};
    const std::vector<std::size_t> cut = contacts_across(lattice, crack);
    std::vector<double> radii = lattice.radii;
    for (std::size_t c = 0; c < lattice.contacts.size(); ++c) {
      const auto i = static_cast<std::size_t>(lattice.contacts[c].i),
                 j = static_cast<std::size_t>(lattice.contacts[c].j);
      if (std::ranges::binary_search(cut, c)) {
        radii[lattice.centres[i].y > lattice.centres[j].y ? i : j] = r - gap;
        continue;
      }
      const double mass = inertia_of(r, frictional_density, Body::disc).mass,
                   dashpot = 0.1 * std::sqrt(mass * frictional_springs.kN);
      bonds.push_back({.i = std::min(i, j),
                       .j = std::max(i, j),
                       .normal_dashpot = dashpot,
                       .tangential_dashpot = dashpot,
                       .normal_spring = frictional_springs.kN,
                       .tangential_spring = frictional_springs.kT});
    }
    for (std::size_t k = 0; k < radii.size(); ++k) {
      discs.push_back({.position = lattice.centres[k] + Vec2{2 * r, r - low.y},
                       .radius = radii[k],
                       .inertia = inertia_of(radii[k], frictional_density, Body::disc)});
      box = {std::max(box.x, discs.back().position.x + 3 * r), std::max(box.y, discs.back().position.y + r)};
    }
  }
};

/// Both go to the levels one after another, from where the motion is.
std::vector<FrictionalLevel> follow(SlowGrains& slow, const HeldDiscs& held, const Push& load,
                                    std::span<const double> to) {
  const Push from = slow.at();
  std::vector<double> legs;
  std::vector<FrictionalLevel> levels;
  for (const double lambda : to) {
    slow.push_to(from + lambda * load);
    legs.push_back(lambda);
    levels.push_back(level_of(held, load, legs, slow.forces()));
  }
  return levels;
}

const std::vector<double> loaded_and_unloaded{0.25, 0.5, 0.75, 1, 0.5, 0};

/// Discs that jammed, pressed and sheared by their lid, which then moves back and further down by some times their
/// overlaps.
std::vector<FrictionalLevel> under_a_lid(double overlap, double steps) {
  Vec2 box;
  const std::vector<Grain> discs = jammed_discs(60, overlap, box);
  SlowGrains slow(discs, box, {}, steps);
  const double way = 0.04 * overlap;
  slow.push_to({{way, -way}, {}});
  const HeldDiscs held = held_discs(slow.packing(), 20 * overlap, {});
  return follow(slow, held, {{-2 * way, -0.3 * way}, {}}, loaded_and_unloaded);
}

double largest_difference(const std::vector<FrictionalLevel>& levels) {
  return std::ranges::max(levels, {}, &FrictionalLevel::force).force;
}

/// \param most of the forces at each level
void check_levels(const std::vector<FrictionalLevel>& levels, double most) {
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const FrictionalLevel& level = levels[k];
    CAPTURE(k, level.why, level.open);
    CHECK(level.force < most);
    CHECK(level.other_contacts == std::vector<std::string>{});
    CHECK(level.ended == PathEnd::legs_done);
  }
}

}  // namespace

// The dashpots of moving contacts add to the force that friction allows: differences fall with the speed, from 5e-4
// here to 6e-5 at a tenth of it.
TEST_CASE("a_packing_whose_lid_moves_carries_the_forces_of_slow_motion") {
  const std::vector<FrictionalLevel> levels = under_a_lid(1e-5, 8000);
  check_levels(levels, 1e-3);
  for (const char* mode : {"open", "close", "slip", "stick"}) {
    CAPTURE(mode);
    CHECK(levels.back().events.at(mode) > 2);
  }
}

TEST_CASE("a_packing_with_forces_at_rest_carries_those_of_slow_motion_as_its_weight_grows") {
  constexpr double overlap = 1e-5;
  Vec2 box;
  const std::vector<Grain> discs = jammed_discs(100, overlap, box);
  SlowGrains slow(discs, box, {}, 8000);
  const double way = 0.004 * overlap;
  slow.push_to({{way, -way}, {}});
  const HeldDiscs held = held_discs(slow.packing(), 20 * overlap, {});
  const std::vector<FrictionalLevel> levels =
      follow(slow, held, {{}, {2.5, -0.75}}, std::vector{0.25, 0.5, 0.75, 1.0, 0.5});
  check_levels(levels, 0.003);
  CHECK(levels.back().events.at("slip") > 50);
  CHECK(levels.back().events.at("stick") > 30);
}

TEST_CASE("a_crack_in_a_block_closes_slips_and_opens_as_in_slow_motion") {
  const CrackedBlock block(1e-7);
  SlowGrains slow(block.discs, block.box, block.bonds, 4000);
  const HeldDiscs held = held_discs(slow.packing(), 1e-3, block.bonds);
  CHECK(held.assembly.contacts.size() > block.bonds.size() + 10);
  const std::vector<double> to{0.25, 0.5, 1, 0.5, 0.25, 0.7};
  const std::vector<FrictionalLevel> levels = follow(slow, held, {{5e-7, -1e-6}, {}}, to);
  check_levels(levels, 1e-3);
  for (const char* mode : {"open", "close", "slip", "stick"}) {
    CAPTURE(mode);
    CHECK(levels.back().events.at(mode) > 4);
  }
}

// Motions are small in statics; in the run contacts turn with the discs. What that changes does not depend on the
// speed: 8e-5, 8e-4 and 7e-3 of the largest force where discs overlap by 1e-4, 1e-3 and 1e-2 of their radius.
TEST_CASE("the_difference_to_slow_motion_falls_with_its_speed_and_with_the_overlaps") {
  const double fast = largest_difference(under_a_lid(1e-5, 2000)), slow = largest_difference(under_a_lid(1e-5, 8000));
  const double deep = largest_difference(under_a_lid(1e-2, 3000)),
               deep_slow = largest_difference(under_a_lid(1e-2, 6000));
  CAPTURE(fast, slow, deep, deep_slow);
  CHECK(slow < fast / 2);
  CHECK(deep_slow == Approx(deep).epsilon(0.1));
  CHECK(deep < 0.01);
  CHECK(deep_slow > 5 * slow);
}
