// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Paths with frictional contacts are those of the same network turned, mirrored or in other units: round-off decides
/// on no event. The last forces of a part that is detached vanish exactly with that of the bond that held it, so that
/// round-off alone says which of them is gone first.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/random.hpp"

#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// x -> scale (a, -b; b, a) x, with the first coordinate mirrored before.
struct Placement {
  std::string name;
  double a = 1, b = 0, scale = 1;
  bool mirrored = false;

  [[nodiscard]] Vec2 operator()(Vec2 x) const {
    if (mirrored) x.x = -x.x;
    return {scale * (a * x.x - b * x.y), scale * (b * x.x + a * x.y)};
  }
};

struct Scene {
  Assembly assembly;
  std::vector<SpringConstants> springs{};
  ContactStrengths strengths{};
  double friction = 0;
  std::vector<std::pair<std::string, Vec2>> moved{};  // groups and their motions
  bool turns = true;                                  // discs of these groups
  Vec2 load{}, dead_load{};                           // of the top, in place of its motion
  std::vector<double> legs{};

  void join(std::size_t i, std::size_t j, SpringConstants k, double tension, double shear) {
    const double half = 0.5 * norm(assembly.centres[j] - assembly.centres[i]);
    assembly.contacts.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), 0, 0, half, half});
    springs.push_back(k);
    strengths.tension.push_back(tension);
    strengths.shear.push_back(shear);
  }
  [[nodiscard]] Unbonded at(const Placement& place) const {
    Assembly placed = assembly;
    for (Vec2& x : placed.centres) x = place(x);
    for (double& r : placed.radii) r *= place.scale;
    for (Contact& c : placed.contacts) c.lever_i *= place.scale, c.lever_j *= place.scale;
    ContactStrengths scaled = strengths;
    for (double& f : scaled.tension) f *= place.scale;
    for (double& f : scaled.shear) f *= place.scale;
    LoadPathOptions path;
    for (const auto& [name, by] : moved) {
      const Vec2 u = place(by);
      path.supports.push_back({name, u.x, u.y, turns ? std::nullopt : std::optional<double>(0)});
    }
    path.control = LoadControl::motion;
    if (norm(load) > 0) {
      path.loads = {{"top", LoadKind::total, place(load), 0}};
      path.control = LoadControl::load;
    }
    if (norm(dead_load) > 0) path.dead_loads = {{"top", LoadKind::total, place(dead_load), 0}};
    path.legs = legs;
    return {std::move(placed), ContactSprings(springs), std::move(scaled), path, {friction, {}}};
  }
};

/// Four rows of discs in a perturbed hexagonal lattice, an eighth of their contacts without a bond, whose top moves.
/// \param bonded whether the others have one
Scene draw(std::uint64_t seed, double kT, double friction, std::vector<double> legs, bool bonded = true) {
  Random random(seed);
  Scene s;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4 - row % 2; ++column) {
      const double x = column + 0.5 * (row % 2) + random.uniform(-0.04, 0.04),
                   y = 0.5 * std::numbers::sqrt3 * row + random.uniform(-0.04, 0.04);
      if (row == 0 || row == 3)
        s.assembly.groups[row == 0 ? "bottom" : "top"].discs.push_back(static_cast<std::int32_t>(s.assembly.size()));
      s.assembly.centres.push_back({x, y});
      s.assembly.radii.push_back(0.5);
    }
  }
  for (std::size_t i = 0; i < s.assembly.size(); ++i) {
    for (std::size_t j = i + 1; j < s.assembly.size(); ++j) {
      if (norm(s.assembly.centres[j] - s.assembly.centres[i]) > 1.25) continue;
      const double weibull = std::pow(-std::log(random.uniform(1e-9, 1)), 1.0 / 6);
      const double strength = random.uniform(0, 1) < 0.12 || !bonded ? 0 : 0.25 * weibull;
      s.join(i, j, {1, kT}, strength, 2 * strength);
    }
  }
  s.strengths.friction = 0.4;
  s.friction = friction;
  s.moved = {{"bottom", {0, 0}}, {"top", {0.17, -0.57}}};
  s.legs = std::move(legs);
  return s;
}

/// The path of a scene, checked to be that of all its placements.
std::vector<BreakEvent> path_of_all_placements(const Scene& scene) {
  const std::vector<Placement> places = {{"in other units, to the bit", 1, 0, 1024, false},
                                         {"in other units", 1, 0, 1000, false},
                                         {"turned by a right angle", 0, 1, 1, false},
                                         {"mirrored", 1, 0, 1, true}};
  Unbonded first = scene.at({});
  first.all();
  for (const Placement& place : places) {
    Unbonded other = scene.at(place);
    other.all();
    CAPTURE(place.name, first.run().why(), other.run().why());
    const double near = place.scale == 1024 ? 0 : 1e-9;
    CHECK(other.run().end() == first.run().end());
    CHECK(std::abs(other.run().lambda() - first.run().lambda()) <= near);
    REQUIRE(other.events().size() == first.events().size());
    for (std::size_t k = 0; k < first.events().size(); ++k) {
      CAPTURE(k, first.event(k).lambda, other.event(k).lambda);
      CHECK(other.event(k).contact == first.event(k).contact);
      CHECK(other.event(k).mode == first.event(k).mode);
      CHECK(std::abs(other.event(k).lambda - first.event(k).lambda) <= near);
    }
  }
  return first.events();
}

}  // namespace

TEST_CASE("a_disc_that_is_left_on_one_bond_ends_no_path_however_the_scene_lies") {
  // The disc at the origin hangs on the first contact, is pressed against the second, which has no bond, and is pulled
  // by the third. Without the third it may roll on the first, nothing drives it, and no contact carries a force.
  Scene s;
  s.assembly.centres.push_back({0, 0});
  for (const double degrees : {200, 130, 60}) {
    const double angle = degrees * std::numbers::pi / 180;
    s.assembly.centres.push_back({std::cos(angle), std::sin(angle)});
  }
  s.assembly.radii.assign(4, 0.5);
  s.join(0, 1, {1, 0.4}, 100, 100);
  s.join(0, 2, {1, 0.4}, 0, 0);
  s.join(0, 3, {1, 0.4}, 0.1, 100);
  s.assembly.groups["held"].discs = {1, 2};
  s.assembly.groups["pulled"].discs = {3};
  s.moved = {{"held", {0, 0}}, {"pulled", s.assembly.centres[3]}};
  s.turns = false;
  s.legs = {3};
  double pressed = 0;
  for (int k = 0; k < 40; ++k) {
    const double angle = 0.1 + 2 * std::numbers::pi * k / 40;
    Unbonded path = s.at({"", std::cos(angle), std::sin(angle), 1, k % 2 == 1});
    REQUIRE(path.run().advance());
    pressed = std::max(pressed, path.run().contact_state().largest_force());
    path.all();
    CAPTURE(k, angle, path.run().why(), path.events().size());
    REQUIRE(path.events().size() == 1);
    CHECK(path.event(0).contact == 2);
    CHECK(path.event(0).mode == BreakMode::tension);
    CHECK(path.run().end() == PathEnd::legs_done);
    for (const ContactForce& f : path.run().contact_state().forces())
      CHECK(std::max(std::abs(f.normal), std::abs(f.tangential)) < 1e-13);
    CHECK(path.run().loose() == std::vector<std::int32_t>{0});
  }
  CHECK(pressed > 0.09);
}

TEST_CASE("paths_with_frictional_contacts_are_those_of_the_scene_turned_mirrored_and_in_other_units") {
  struct Kind {
    double kT, friction;
  };
  std::size_t events = 0, breaks = 0;
  for (const Kind& kind : {Kind{0.4, 0.3}, Kind{0.4, 0}, Kind{0, 0.3}}) {
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
      CAPTURE(seed, kind.kT, kind.friction);
      // Half of the paths are pressed, pulled and pressed again, the others come to rest without a load between.
      const std::vector<BreakEvent> path = path_of_all_placements(
          draw(seed, kind.kT, kind.friction, seed % 2 == 0 ? std::vector{2.0, -0.5, 6.0} : std::vector{3.0, 0.0, 3.0}));
      events += path.size();
      for (const BreakEvent& e : path) breaks += e.mode == BreakMode::tension || e.mode == BreakMode::shear;
    }
  }
  CAPTURE(events, breaks);
  CHECK(breaks > 72);
  CHECK(events > 2 * breaks);
}

// Loads that drive a motion which nothing resists end a path, with the contacts that give way. The rates of that motion
// are those of hardly any stiffness, and forces are small beside what such motions would cost.
TEST_CASE("paths_under_loads_end_with_the_same_contacts_turned_mirrored_and_in_other_units") {
  std::size_t ends = 0;
  for (const bool bonded : {true, false}) {
    for (std::uint64_t seed = 1; seed <= 120; ++seed) {
      CAPTURE(seed, bonded);
      Scene scene = draw(seed, 0.4, 0.3, {1, -0.5, 2}, bonded);
      scene.moved.pop_back();
      scene.load = {0.2, -0.3};
      scene.dead_load = {0, -0.4};
      const std::vector<BreakEvent> path = path_of_all_placements(scene);
      ends += !path.empty() && path.back().lambda < 1;
    }
  }
  CAPTURE(ends);
  CHECK(ends > 60);
}
