// SPDX-License-Identifier: GPL-3.0-or-later
/// Load and motion do not depend on the axes, nor on which of two sides moves.
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/power_cells.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/core/random.hpp"

#include "breakage/unbonded_scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Vec2 turned(Vec2 v, double degrees) {
  const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  return {c * v.x - s * v.y, s * v.x + c * v.y};
}

Assembly turned(Assembly assembly, double degrees) {
  for (Vec2& centre : assembly.centres) centre = turned(centre, degrees);
  assembly.box.reset();
  return assembly;
}

/// A sample that is pulled askew, by imposed motions or by loads on its top, with a notch from its left side.
struct NotchedSample {
  Assembly assembly = delaunay_assembly({.discs = 60,
                                         .points = PointProcess::perturbed_hexagonal,
                                         .disorder = 0.25,
                                         .seed = 3,
                                         .radii = {.smallest = 0.5, .largest = 0.5}});
  ContactSprings springs{SpringConstants{1000, 300}};
  ContactStrengths strengths;
  std::vector<std::size_t> cut;

  NotchedSample() {
    Random random(5);
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      strengths.tension.push_back(random.uniform(0.5, 1.5));
      strengths.shear.push_back(random.uniform(1, 3));
    }
    strengths.friction = 0.5;
    const Rectangle box = region_of_cells(assembly);
    const double middle = 0.5 * (box.low.y + box.high.y);
    const Notch notch{{box.low.x - 1, middle}, {box.low.x + 0.3 * (box.high.x - box.low.x), middle}};
    cut = contacts_across(assembly, {&notch, 1});
  }
  [[nodiscard]] std::vector<BreakEvent> broken(double degrees, bool loads, double share_of_bottom) const {
    const Vec2 pull = turned({4e-4, 1e-3}, degrees), bottom = -share_of_bottom * pull, top = bottom + pull;
    LoadPathOptions options;
    options.supports = {{"bottom", loads ? 0 : bottom.x, loads ? 0 : bottom.y, {}}};
    if (loads) options.loads = {{"top", LoadKind::per_disc, pull, 0}};
    if (!loads) options.supports.push_back({"top", top.x, top.y, {}});
    ContactStrengths notched = strengths;
    for (const std::size_t contact : cut) notched.tension[contact] = notched.shear[contact] = 1e-9;
    return Broken(turned(assembly, degrees), springs, notched, options).all().events();
  }
};

}  // namespace

TEST_CASE("a_chain_breaks_at_one_load_and_elongation_at_any_angle_and_whichever_end_moves") {
  constexpr double weakest = 10, kN = 1e6, elongation = 2 * weakest / kN;  // two contacts in a row
  for (const double degrees : {0.0, 30.0, 37.0, 45.0, 90.0, 135.0, 200.0}) {
    for (const double share : {0.0, 0.25, 0.5, 1.0, 2.0, -1.0}) {  // of the elongation, by which the first end moves
      const Assembly chain = turned(chain_of_discs(3, 1), degrees);
      const Vec2 along = turned({1e-5, 0}, degrees);
      LoadPathOptions options;
      options.supports = {{"first", -share * along.x, -share * along.y, 0},
                          {"last", (1 - share) * along.x, (1 - share) * along.y, 0}};
      options.control = LoadControl::motion;
      options.legs = {3};
      ContactStrengths strengths = equal_strengths(chain, 20, 1e9);
      strengths.tension[1] = weakest;
      const ContactSprings springs(SpringConstants{kN, 0.3e6});
      Broken gone(chain, springs, strengths, options);
      Unbonded frictional(chain, springs, strengths, options, {0.4, {}});
      CAPTURE(degrees, share);
      REQUIRE(gone.all().events().size() == 1);
      REQUIRE(!frictional.all().events().empty());
      for (const BreakEvent& event : {gone.event(0), frictional.event(0)}) {
        CHECK(event.load == Approx(weakest).epsilon(1e-9));
        CHECK(event.motion == Approx(elongation).epsilon(1e-9));
        CHECK(event.lambda == Approx(elongation / 1e-5).epsilon(1e-9));
      }
    }
  }
}

// The contact lets go at its strength, of which the dead load on the disc takes its part and the support the rest.
TEST_CASE("a_support_that_moves_a_disc_carries_what_the_dead_load_on_it_does_not") {
  constexpr double strength = 5;
  const double pull = GENERATE(-3.0, 0.0, 2.0);
  const Assembly chain = chain_of_discs(2, 1);
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", 1e-3, 0, 0}};
  options.dead_loads = {{"last", LoadKind::per_disc, {pull, 0}, 0}};
  options.control = LoadControl::motion;
  options.legs = {1};
  const ContactSprings springs(SpringConstants{1e6, 0.3e6});
  Broken gone(chain, springs, equal_strengths(chain, strength, 1e9), options);
  Unbonded frictional(chain, springs, equal_strengths(chain, strength, 1e9), options, {0.4, {}});
  REQUIRE(gone.all().events().size() == 1);
  REQUIRE(!frictional.all().events().empty());
  for (const BreakEvent& event : {gone.event(0), frictional.event(0)}) {
    CAPTURE(pull, event.load, event.motion);
    CHECK(std::abs(event.load - (strength - pull)) < 1e-9 * strength);
    CHECK(std::abs(event.motion - strength / 1e6) < 1e-9 * strength / 1e6);
  }
}

TEST_CASE("a_sample_has_one_curve_however_it_is_turned_and_whichever_side_moves") {
  const NotchedSample sample;
  for (const bool loads : {false, true}) {
    const std::vector<BreakEvent> expected = sample.broken(0, loads, 0);
    REQUIRE(expected.size() > sample.cut.size() + 5);
    for (const auto& [degrees, share] : {std::pair{90.0, 0.0}, {37.0, 0.0}, {0.0, 0.5}, {37.0, 0.25}}) {
      const std::vector<BreakEvent> found = sample.broken(degrees, loads, share);
      REQUIRE(found.size() == expected.size());
      for (std::size_t k = 0; k < found.size(); ++k) {
        CAPTURE(loads, degrees, share, k);
        REQUIRE(found[k].contact == expected[k].contact);
        CHECK(found[k].load == Approx(expected[k].load).epsilon(1e-7));
        CHECK(found[k].motion == Approx(expected[k].motion).epsilon(1e-7));
      }
    }
  }
}

TEST_CASE("the_motion_is_how_far_two_supports_move_from_each_other") {
  // A square of four touching discs of radius 1, each side a group: neighbouring sides share a disc.
  Assembly square;
  square.centres = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  square.radii.assign(4, 1.0);
  square.contacts = {{0, 1, 0, 0, 1, 1}, {1, 2, 0, 0, 1, 1}, {2, 3, 0, 0, 1, 1}, {3, 0, 0, 0, 1, 1}};
  square.groups = {{"left", {{0, 3}, {}}}, {"right", {{1, 2}, {}}}, {"bottom", {{0, 1}, {}}}, {"top", {{2, 3}, {}}}};
  const ContactSprings springs(SpringConstants{1000, 300});
  const auto size = [&](std::vector<Support> supports) {
    LoadPathOptions options;
    options.supports = std::move(supports);
    return make_load_path(square, springs, derive_effects(square, springs, Rotation::from_scene), options).size;
  };
  const std::optional<double> free;
  CHECK(size({{"left", 0, 0, free}, {"right", 3e-3, free, free}}) == 3e-3);
  CHECK(size({{"left", 0, 0, free}, {"right", 3e-3, 4e-3, free}}) == Approx(5e-3).epsilon(1e-15));
  CHECK(size({{"left", 0, 0, free}, {"right", 3e-3, free, free}, {"right", free, 4e-3, free}}) ==
        Approx(5e-3).epsilon(1e-15));
  // A component that only one of two supports prescribes is not held against the other: plates that press from four
  // sides.
  CHECK(size({{"left", 1e-3, free, free},
              {"right", -2e-3, free, free},
              {"bottom", free, 1e-3, free},
              {"top", free, -1e-3, free}}) == Approx(3e-3).epsilon(1e-15));
  // Rotations times the mean radius: of one side from rest, of two sides from each other.
  CHECK(size({{"left", 0, 0, free}, {"right", 0, 0, 1e-2}}) == 1e-2);
  CHECK(size({{"left", 0, 0, -1e-2}, {"right", 0, 0, 1e-2}}) == 2e-2);
  // Nothing moves against anything else.
  CHECK(size({{"left", 3e-3, 4e-3, free}, {"right", 3e-3, 4e-3, free}}) == Approx(5e-3).epsilon(1e-15));
  CHECK(size({{"top", 2e-3, free, free}}) == 2e-3);
}
