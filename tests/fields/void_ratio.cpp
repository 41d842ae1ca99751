// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/fields/box_measures.hpp"

#include "fields/bodies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("the_void_ratio_of_every_shape_is_that_of_points_thrown_at_random") {
  for (const GrainShape shape : {GrainShape::disc, GrainShape::ellipse, GrainShape::clump}) {
    const Bodies bodies = scattered(shape, 60, 3);
    const Rectangle region{{0.2, 0.1}, {0.9, 0.7}};
    const SolidMeasures measures = solid_measures(clipped_area(bodies.grains, bodies.clumps, region), region);
    Random random(7);
    constexpr int points = 20'000;
    int inside = 0;
    for (int k = 0; k < points; ++k) {
      const Vec2 place{random.uniform(0.2, 0.9), random.uniform(0.1, 0.7)};
      for (const Grain& grain : bodies.grains) inside += holds(grain, bodies.clumps, place) ? 1 : 0;
    }
    const double thrown = static_cast<double>(inside) / points;
    CAPTURE(static_cast<int>(shape), measures.solid_fraction, thrown);
    CHECK(measures.solid_fraction == Approx(thrown).margin(6 * std::sqrt(thrown / points)));
    CHECK(measures.porosity == Approx(1 - measures.solid_fraction));
    CHECK(measures.void_ratio / (1 + measures.void_ratio) == Approx(measures.porosity));
  }
}

TEST_CASE("the_densest_lattice_has_the_void_ratio_of_the_book") {
  // Whole cells of the hexagonal lattice, wherever they are cut.
  std::vector<Grain> grains;
  const double r = 0.01, height = std::sqrt(3.0) * r;
  for (int row = -2; row < 24; ++row)
    for (int column = -2; column < 24; ++column)
      grains.push_back(disc({2 * r * column + (row % 2 == 0 ? 0 : r), height * row}, r));
  const double e = 2 * std::sqrt(3.0) / std::numbers::pi - 1;
  for (const Vec2 corner : {Vec2{0, 0}, Vec2{0.0033, 0.0071}}) {
    const Rectangle region{corner, corner + Vec2{2 * r * 15, height * 14}};
    CHECK(solid_measures(clipped_area(grains, {}, region), region).void_ratio == Approx(e).epsilon(1e-12));
  }
}

TEST_CASE("the_measured_region_leaves_walls_and_surface_out_and_goes_with_the_box") {
  std::vector<Grain> grains;
  const double r = 0.01;
  for (int row = 0; row < 20; ++row)
    for (int column = 0; column < 30; ++column) grains.push_back(disc({r * (1 + 2 * column), r * (1 + 2 * row)}, r));
  grains.push_back(disc({0.3, 2}, r));  // in the air: it lifts one column alone
  std::vector<Wall> walls{line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}),
                          line("right", {0.6, 0}, {-1, 0})};
  for (Wall& wall : walls) wall.move_x = {.kind = Schedule::Kind::ramp, .value = 0.05, .end = 1};
  for (Grain& grain : grains) grain.position.x += 0.05;
  const GrainBox box = box_of(walls, grains, 1);
  CHECK_FALSE(box.lid);
  CHECK(box.inside.low == Vec2{0.05, 0});
  CHECK(box.inside.high.x == Approx(0.65));
  const auto region = measured_region(grains, {}, box);
  REQUIRE(region);
  CHECK(region->low.x == Approx(0.05 + 4 * r));
  CHECK(region->low.y == Approx(4 * r));
  CHECK(region->high.x == Approx(0.65 - 4 * r));
  CHECK(region->high.y == Approx(0.4 - 6 * r));
  CHECK(solid_measures(clipped_area(grains, {}, *region), *region).solid_fraction ==
        Approx(std::numbers::pi / 4).epsilon(1e-12));

  walls.push_back(line("lid", {0, 0.4}, {0, -1}));
  const GrainBox closed = box_of(walls, {grains.data(), grains.size() - 1}, 1);
  CHECK(closed.lid);
  CHECK(measured_region(grains, {}, closed)->high.y == Approx(0.4 - 4 * r));
  // Too few rows leave nothing to measure.
  walls.pop_back();
  const std::span<const Grain> few(grains.data(), 90);
  CHECK_FALSE(measured_region(few, {}, box_of(walls, few, 1)));
}
