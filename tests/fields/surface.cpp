// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/fields/box_measures.hpp"

#include "fields/bodies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("the_surface_is_the_highest_point_that_bodies_have_in_a_column") {
  for (const GrainShape shape : {GrainShape::disc, GrainShape::ellipse, GrainShape::clump}) {
    const Bodies bodies = scattered(shape, 40, 11);
    const SurfaceProfile surface = surface_of(bodies.grains, bodies.clumps, 0.1, 0.8, 23);
    REQUIRE(surface.heights.size() == 23);
    // Points close together along every outline.
    std::vector<double> highest(23, -1);
    const auto raise = [&](Vec2 centre, Vec2 axis, double a, double b) {
      constexpr int points = 4000;
      for (int p = 0; p < points; ++p) {
        const double t = 2 * std::numbers::pi * p / points;
        const Vec2 x = centre + a * std::cos(t) * axis + b * std::sin(t) * perpendicular(axis);
        const double column = std::floor((x.x - 0.1) / (0.7 / 23));
        if (column >= 0 && column < 23) {
          double& height = highest[static_cast<std::size_t>(column)];
          height = std::max(height, x.y);
        }
      }
    };
    for (const Grain& grain : bodies.grains) {
      const Vec2 axis{std::cos(grain.angle), std::sin(grain.angle)};
      if (shape != GrainShape::clump) {
        raise(grain.position, axis, grain.radius, shape == GrainShape::ellipse ? grain.short_half_axis : grain.radius);
        continue;
      }
      for (const Clump::Disc& disc : bodies.clumps[static_cast<std::size_t>(grain.clump)].discs)
        raise(grain.position + disc.offset.x * axis + disc.offset.y * perpendicular(axis), axis, disc.radius,
              disc.radius);
    }
    for (std::size_t k = 0; k < 23; ++k) {
      CAPTURE(static_cast<int>(shape), k, surface.heights[k], highest[k]);
      if (std::isnan(surface.heights[k])) {
        CHECK(highest[k] == -1);
        continue;
      }
      CHECK(surface.heights[k] >= highest[k] - 1e-12);
      CHECK(surface.heights[k] <= highest[k] + 2e-3);  // an upright flank between two points
    }
  }
}

TEST_CASE("slope_and_roughness_are_those_of_the_line_of_least_squares") {
  SurfaceProfile profile{.left = -1, .width = 0.5, .heights = {}};
  // Off the line in a pattern that has no part along it.
  const double off[] = {1, -1, -1, 1, 1, -1, -1, 1};
  for (int k = 0; k < 8; ++k)
    profile.heights.push_back(2 + 0.3 * profile.place(static_cast<std::size_t>(k)) + 0.01 * off[k]);
  const SurfaceShape shape = shape_of(profile);
  CHECK(shape.height == Approx(2 + 0.3));  // the middle is at x = 1
  CHECK(shape.slope == Approx(0.3));
  CHECK(shape.roughness == Approx(0.01));
  profile.heights.push_back(NAN);
  CHECK(shape_of(profile).roughness == Approx(0.01));
  CHECK(std::isnan(shape_of({.left = 0, .width = 1, .heights = {NAN}}).height));
}

TEST_CASE("what_flies_is_apart_from_the_heap_and_a_chain_of_neighbours_is_not") {
  std::vector<Grain> grains;
  for (int k = 0; k < 20; ++k) grains.push_back(disc({2.0 * k, 0}, 1));
  grains.push_back(disc({10, 2.4}, 1));  // hops by less than the gap
  grains.push_back(disc({10, 7}, 1));    // flies
  grains.push_back(disc({12, 7.5}, 1));  // flies along
  const std::vector<char> heap = heap_of(grains, 1);
  CHECK(std::count(heap.begin(), heap.end(), 0) == 2);
  CHECK(heap[20] == 1);
  CHECK(heap[21] + heap[22] == 0);
  const SurfaceProfile with = surface_of(grains, {}, 0, 38, 19), without = surface_of(grains, {}, 0, 38, 19, heap);
  CHECK(with.heights[5] == Approx(8.5));  // the right one reaches into the column at its side
  CHECK(without.heights[5] == Approx(3.4));
  CHECK(centre_of_mass(grains).y == Approx((2.4 + 7 + 7.5) / 23));
}
