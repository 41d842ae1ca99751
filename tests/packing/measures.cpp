// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/measures.hpp"

#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"

#include "packing/packings.hpp"
#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("clipped_areas_agree_with_points_thrown_at_random") {
  Random random(3);
  const Rectangle region = {{0, 0}, {1, 0.6}};
  constexpr int points = 20000;
  for (int k = 0; k < 60; ++k) {
    const double radius = random.uniform(0.05, 0.9);
    const double x = random.uniform(-0.6, 1.6);
    const Vec2 centre = {x, random.uniform(-0.6, 1.2)};
    int hits = 0;
    for (int p = 0; p < points; ++p) {
      const double px = random.uniform(region.low.x, region.high.x);
      const Vec2 way = Vec2{px, random.uniform(region.low.y, region.high.y)} - centre;
      if (dot(way, way) < radius * radius) ++hits;
    }
    const double thrown = region.area() * hits / points;
    CAPTURE(centre.x, centre.y, radius);
    CHECK(clipped_area(centre, radius, region) == Approx(thrown).margin(4.5 * region.area() * 0.5 / std::sqrt(points)));
  }
}

TEST_CASE("clipped_areas_of_special_places_are_exact") {
  const Rectangle region = {{0, 0}, {2, 1}};
  const double whole = std::numbers::pi * 0.01;
  CHECK(clipped_area({1, 0.5}, 0.1, region) == Approx(whole).epsilon(1e-14));
  CHECK(clipped_area({1, 0.1}, 0.1, region) == Approx(whole).epsilon(1e-14));
  CHECK(clipped_area({1, 0}, 0.1, region) == Approx(whole / 2).epsilon(1e-14));
  CHECK(clipped_area({2, 1}, 0.1, region) == Approx(whole / 4).epsilon(1e-14));
  CHECK(clipped_area({1, 0.5}, 10, region) == Approx(2).epsilon(1e-14));
  CHECK(clipped_area({1, 1.2}, 0.1, region) == Approx(0).margin(1e-16));
  CHECK(clipped_area({1, 1.1}, 0.1, region) == Approx(0).margin(1e-16));
  // A segment: r² (alpha - sin alpha cos alpha), cos alpha = 1/2.
  const double alpha = std::numbers::pi / 3;
  CHECK(clipped_area({1, 1.05}, 0.1, region) ==
        Approx(0.01 * (alpha - std::sin(alpha) * std::cos(alpha))).epsilon(1e-13));
}

TEST_CASE("regions_that_tile_the_box_hold_all_discs_between_them") {
  const auto sides = GENERATE(PackingBox::Sides::walls, PackingBox::Sides::periodic);
  const GrainPacking packing = pack(square_box(PackingMethod::growth, sides, 300, 0.8));
  const Vec2 size = packing.box.size;
  const double x = 0.37 * size.x, y = 0.61 * size.y;
  double covered = 0;
  for (const Rectangle& region : {Rectangle{{0, 0}, {x, y}}, Rectangle{{x, 0}, {size.x, y}},
                                  Rectangle{{0, y}, {x, size.y}}, Rectangle{{x, y}, size}})
    covered += measure(packing, region).solid_fraction * region.area();
  CHECK(covered == Approx(area_of_discs(packing.radii)).epsilon(1e-12));
}

TEST_CASE("a_region_without_bodies_or_out_of_a_periodic_box_is_refused") {
  const auto sides = GENERATE(PackingBox::Sides::walls, PackingBox::Sides::periodic);
  const GrainPacking packing = packing_of({{4, 2}, sides}, {{0.5, 0.5}}, {0.5});
  CHECK_NOTHROW(measure(packing, Rectangle{{0, 0}, {1, 1}}));
  CHECK_THROWS_AS(measure(packing, Rectangle{{1.5, 0}, {2, 1}}), Error);
  CHECK_THROWS_AS(measure(packing, Rectangle{{8, 8}, {9, 9}}), Error);
}

TEST_CASE("contacts_rattlers_and_void_ratio_of_a_row_of_discs_are_counted_by_hand") {
  GrainPacking packing = packing_of({{4, 2}, PackingBox::Sides::walls},
                                    {{0.5, 0.5}, {1.5, 0.5}, {2.499, 0.5}, {3.2, 1.2}}, {0.5, 0.5, 0.5, 0.3});
  const PackingMeasures measures = measure(packing, Rectangle{{0, 0}, {4, 2}});
  CHECK(measures.contacts == 2);       // 0-1, 1-2
  CHECK(measures.wall_contacts == 4);  // three on the floor, one at the left
  CHECK(measures.coordination == 8.0 / 4);
  // Three contacts hold a disc: 0 has floor, wall and 1; 1 has floor, 0, 2; 2 has two, so that it and then 1 and 0 are
  // loose.
  CHECK(measures.rattlers == 4);
  CHECK(measures.largest_overlap == Approx(0.001 / 0.5));
  const double solid = std::numbers::pi * (3 * 0.25 + 0.09) / 8;
  CHECK(measures.solid_fraction == Approx(solid).epsilon(1e-13));
  CHECK(measures.void_ratio == Approx((1 - solid) / solid).epsilon(1e-13));
  CHECK(measures.void_ratio == Approx(measures.porosity / (1 - measures.porosity)).epsilon(1e-13));
  packing.box.sides = PackingBox::Sides::open_top;  // two hold it where weight presses it down
  CHECK(measure(packing, Rectangle{{0, 0}, {4, 2}}).rattlers == 1);
  CHECK_THROWS_AS(measure(packing, Rectangle{{1, 0}, {0, 1}}), Error);
}

TEST_CASE("discs_touch_across_the_sides_of_a_periodic_box") {
  const GrainPacking packing =
      packing_of({{1, 1}, PackingBox::Sides::periodic}, {{0.05, 0.05}, {0.96, 0.96}, {0.5, 0.5}}, {0.1, 0.1, 0.05});
  const auto contacts = contacts_of(packing);
  REQUIRE(contacts.size() == 1);
  CHECK(contacts[0].i == 0);
  CHECK(contacts[0].j == 1);
  CHECK(contacts[0].shift_x == -1);
  CHECK(contacts[0].shift_y == -1);
  CHECK(contacts[0].overlap == Approx(0.2 - std::hypot(0.09, 0.09)));
}

TEST_CASE("the_region_measured_keeps_away_from_walls_and_surface") {
  const GrainPacking packing = pack(square_box(PackingMethod::growth, PackingBox::Sides::walls, 400, 0.8));
  const Rectangle region = measured_region(packing);
  double mean = 0;
  for (const double r : packing.radii) mean += r / static_cast<double>(packing.size());
  CHECK(region.low.x == Approx(4 * mean));
  CHECK(packing.box.size.y - region.high.y == Approx(4 * mean));
}

TEST_CASE("a_packing_and_a_run_of_it_have_one_void_ratio") {
  // under an open top with a step in the surface, and shapes whose radii are not those of circles of equal area
  GrainPacking packing = packing_of({{40, 20}, PackingBox::Sides::open_top}, {}, {});
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < (row < 8 ? 20 : 10); ++column)
      packing.grains.push_back(
          {.position = {1.0 + 2 * column, 1.0 + 2 * row}, .radius = 1, .inertia = {1, 1}, .short_half_axis = 0.7});
  packing.radii.assign(packing.grains.size(), 1);
  GrainScene scene;
  scene.grains = packing.grains;
  scene.walls = walls_of(packing.box);
  BoxMeasures run(scene, {});
  CHECK(measure(packing).void_ratio == run.record(0, 0, scene.grains, scene.walls).void_ratio);
}
