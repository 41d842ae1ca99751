// SPDX-License-Identifier: GPL-3.0-or-later
/// Where legs and paths end, and what is told of it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "breakage/random_packings.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double kN = 1000, weak = 1, strong = 2.6, apart = 2 * weak / kN;  // Pa, N/m, m: contacts in a row share it

/// Two chains of two contacts each between one held end and one that moves, which breaks the weak chain at lambda = 1
/// under the load 2 weak.
Broken two_chains(std::vector<double> legs) {
  Assembly chains = chain_of_discs(3, 1);
  for (int disc = 0; disc < 3; ++disc) {
    chains.centres.push_back({2.0 * disc, 5});
    chains.radii.push_back(1);
    if (disc > 0) chains.contacts.push_back({disc + 2, disc + 3, 0, 0, 1, 1});
  }
  chains.groups["first"].discs = {0, 3};
  chains.groups["last"].discs = {2, 5};
  ContactStrengths strengths = equal_strengths(chains, strong, 1e9);
  strengths.tension[0] = weak;
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", apart, 0, 0}};
  options.control = LoadControl::load;
  options.legs = std::move(legs);
  return {std::move(chains), ContactSprings(SpringConstants{kN, 300}), strengths, options};
}

/// \return "lambda load motion, ..." of the start and of the ends of legs
std::string shown(const std::vector<LegPoint>& points) {
  std::string text;
  for (const LegPoint& point : points) text += fmt::format("{} {} {}, ", point.lambda, point.load, point.motion);
  return text;
}

}  // namespace

TEST_CASE("a_leg_ends_where_the_load_that_is_held_has_driven_the_motion") {
  // The chain that is left takes the load of both at twice the motion: beyond the end of the leg.
  Broken path = two_chains({1.1, 0.5, 1.2});
  const std::vector<LegPoint> points = path.all().run().leg_points();
  CAPTURE(shown(points), path.run().why());
  REQUIRE(path.events().size() == 1);
  REQUIRE(points.size() == 4);
  CHECK(path.run().lambda() == Approx(1.2).epsilon(1e-12));
  const double lambda[] = {0, 2, 0.5, 1.2};
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(points[k].lambda == Approx(lambda[k]).epsilon(1e-12));
    CHECK(points[k].load == Approx(weak * lambda[k]).epsilon(1e-12));
    CHECK(points[k].motion == Approx(apart * lambda[k]).epsilon(1e-12));
  }
}

TEST_CASE("a_path_that_is_resumed_behind_a_held_load_has_the_ends_of_legs_of_a_whole_one") {
  Broken whole = two_chains({1.1, 0.5, 3});
  whole.all();
  REQUIRE(whole.events().size() == 2);
  CHECK(whole.event(1).lambda == Approx(strong / weak).epsilon(1e-12));
  const std::string expected = shown(whole.run().leg_points());
  for (std::size_t kept = 0; kept <= 2; ++kept) {
    Broken part = two_chains({1.1, 0.5, 3});
    part.run().resume({whole.events().begin(), whole.events().begin() + static_cast<std::ptrdiff_t>(kept)});
    part.all();
    CAPTURE(kept, expected, shown(part.run().leg_points()));
    REQUIRE(part.events().size() == 2);
    const std::vector<LegPoint> ours = part.run().leg_points(), theirs = whole.run().leg_points();
    REQUIRE(ours.size() == theirs.size());
    for (std::size_t k = 0; k < ours.size(); ++k) {
      CHECK(ours[k].lambda == Approx(theirs[k].lambda).epsilon(1e-12));
      CHECK(ours[k].load == Approx(theirs[k].load).epsilon(1e-12));
      CHECK(ours[k].motion == Approx(theirs[k].motion).epsilon(1e-12));
    }
  }
}

TEST_CASE("under_control_of_the_motion_a_load_that_nothing_resists_does_not_grow") {
  // Springs, strengths and loads are about 1: loads are carried by motions of that size, or of a few thousands where
  // hardly anything holds a disc. What moves further has come free.
  constexpr double far = 1e6;
  std::int64_t free = 0, carried = 0;
  for (std::uint64_t seed = 2; seed <= 800; seed += 2) {
    if (seed % 3 == 0) continue;
    DrawnPacking d = draw_packing(seed);
    d.path.control = LoadControl::motion;
    d.path.max_events = 60;
    Unbonded path{d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation};
    path.all();
    double farthest = 0, load = 0;
    const auto take = [&](const auto& point) {
      farthest = std::max(farthest, std::abs(point.motion));
      if (std::abs(point.motion) > far) load = std::max(load, std::abs(point.load));
    };
    std::ranges::for_each(path.run().leg_points(), take);
    std::ranges::for_each(path.events(), take);
    CAPTURE(d.name, path.run().why(), path.run().lambda(), farthest, path.events().size());
    CHECK(load < 1e-12);
    (path.run().end() == PathEnd::carries_nothing ? free : carried) += 1;
  }
  CAPTURE(free, carried);
  CHECK(free > 10);
  CHECK(carried > 10);
}

TEST_CASE("bonds_that_break_as_a_part_comes_free_tell_what_they_have_released") {
  std::int64_t within = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const DrawnPacking d = draw_packing(seed);
    Unbonded path{d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation};
    path.all();
    double sum = 0;
    for (const BreakEvent& event : path.events()) sum += event.energy_released;
    CAPTURE(d.name, path.run().why(), sum, path.run().ledger().released);
    CHECK(sum == Approx(path.run().ledger().released).epsilon(1e-12).margin(1e-12));
    within += path.run().releasing() && path.run().ledger().released > 0 ? 1 : 0;
  }
  CHECK(within > 5);
}
