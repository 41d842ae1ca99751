// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sizes, places and units far from one.
#include <cmath>
#include <cstdint>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"

#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Problem pulled(Assembly block, SpringConstants k, Vec2 force) {
  return {std::move(block),
          ContactSprings(k),
          {{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}},
          {{.group = "right", .kind = LoadKind::per_disc, .force = force}}};
}

}  // namespace

TEST_CASE("radii_of_1000_to_1_are_right") {
  HardCase table({.name = "radii in ratio 1000:1",
                  .why = "lever arms enter K squared: its entries differ by a factor of a million, in no order"});
  // A spiral: each disc touches the two before it, which are larger; neighbours differ by a factor of 2.
  Assembly spiral;
  Vec2 at{0, 0};
  for (int d = 0; d < 11; ++d) {
    const double radius = std::pow(0.5, d);
    spiral.centres.push_back(at);
    spiral.radii.push_back(radius);
    const double angle = 0.9 * d;
    at += 1.5 * radius * Vec2{std::cos(angle), std::sin(angle)};
    for (int before = std::max(0, d - 2); before < d; ++before) {
      const double length = norm(spiral.centres[d] - spiral.centres[before]);
      const double share = spiral.radii[before] / (spiral.radii[before] + radius);
      spiral.contacts.push_back({before, d, 0, 0, share * length, (1 - share) * length});
    }
  }
  spiral.groups["left"].discs = {0};
  for (const double ratio : {0.5, 1e-3, -0.01}) {
    for (const std::int32_t end : {1, 5, 10}) {
      CAPTURE(ratio, end);
      spiral.groups["right"].discs = {end};
      Problem problem = pulled(spiral, {1e9, ratio * 1e9}, {1000, 300});
      problem.supports[0].rotation = 0.0;
      table.right("solve", solve(problem), 1e-10);
    }
  }
  for (const std::uint64_t seed : {1, 2, 3}) {
    CAPTURE(seed);
    const RadiusDistribution radii{.smallest = 1e-5, .largest = 1e-2};
    table.right(
        "solve",
        solve(pulled(delaunay_assembly({.discs = 120, .seed = seed, .radii = radii}), {1e9, 0.5e9}, {1000, 300})),
        1e-10);
    table.right("homogenize",
                homogenize(delaunay_assembly({.discs = 120, .seed = seed, .radii = radii, .periodic = true}),
                           ContactSprings(SpringConstants{1e9, 0.5e9})),
                1e-13);
  }
}

TEST_CASE("an_assembly_far_from_the_origin_is_right") {
  HardCase table(
      {.name = "coordinates a hundred million radii from the origin",
       .why =
           "of the sixteen digits of a coordinate eight are left for the distances: branches and levers disagree, and "
           "gears close only to that"});
  const auto moved = [](Assembly assembly, double distance) {
    for (Vec2& x : assembly.centres) x += Vec2{distance, -distance};
    return assembly;
  };
  const SpringConstants k{1e9, 0.5e9};
  for (const double distance : {1.0, 1e3, 5e5}) {
    CAPTURE(distance);
    table.right("solve", solve(pulled(moved(delaunay_assembly({.discs = 200}), distance), k, {1000, 300})), 1e-12);
    table.right("homogenize",
                homogenize(moved(delaunay_assembly({.discs = 60, .periodic = true}), distance), ContactSprings(k)),
                1e-13);
    const Problem square = pulled(moved(square_lattice({.columns = 6, .rows = 6}), distance), k, {1000, 300});
    table.refused("solve a square lattice", solve(square), {"counter-rotate like gears", "Hold the rotation of one"});
    table.right(
        "homogenize a square lattice",
        homogenize(moved(square_lattice({.columns = 4, .rows = 4, .periodic = true}), distance), ContactSprings(k)),
        1e-13);
  }
}

TEST_CASE("units_of_any_size_are_right") {
  HardCase table({.name = "radii from 1e-9 m to 1e6 m, springs from 1 Pa to 1e12 Pa",
                  .why = "no absolute number may decide what is zero"});
  for (const double size : {1e-9, 1.0, 1e6}) {
    for (const double stiffness : {1.0, 1e12}) {
      CAPTURE(size, stiffness);
      const RadiusDistribution radii{.smallest = size, .largest = 2 * size};
      const SpringConstants k{stiffness, 0.3 * stiffness};
      table.right("solve",
                  solve(pulled(delaunay_assembly({.discs = 100, .radii = radii}), k, {1e-3 * size * stiffness, 0})),
                  1e-12);
      table.right("homogenize",
                  homogenize(delaunay_assembly({.discs = 60, .radii = radii, .periodic = true}), ContactSprings(k)),
                  1e-13);
    }
  }
}
