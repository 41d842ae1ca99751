// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/measures.hpp"

#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"

#include "packing/packings.hpp"
#include "support/catch.hpp"

using namespace equidem;

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

TEST_CASE("a_body_in_the_air_changes_the_void_ratio_of_neither_packing_nor_run") {
  // columns of the surface are four radii wide: two bodies above a heap of two columns lift all of it
  GrainPacking packing = packing_of({{20, 60}, PackingBox::Sides::open_top}, {}, {});
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 10; ++column)
      packing.grains.push_back({.position = {1.0 + 2 * column, 1.0 + 2 * row}, .radius = 1, .inertia = {1, 1}});
  const auto heap = static_cast<std::ptrdiff_t>(packing.grains.size());
  for (int column = 0; column < 5; ++column)
    packing.grains.push_back({.position = {2.0 + 4 * column, 59}, .radius = 1, .inertia = {1, 1}});
  packing.radii.assign(packing.grains.size(), 1);
  GrainScene scene;
  scene.grains = packing.grains;
  scene.walls = walls_of(packing.box);
  BoxMeasures run(scene, {});
  CHECK(measure(packing).void_ratio == run.record(0, 0, scene.grains, scene.walls).void_ratio);
  GrainPacking at_rest = packing;
  at_rest.grains.erase(at_rest.grains.begin() + heap, at_rest.grains.end());
  at_rest.radii.resize(at_rest.grains.size());
  CHECK(measure(packing).void_ratio == measure(at_rest).void_ratio);
}
