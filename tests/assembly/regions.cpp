// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/assembly/least_rectangle.hpp"
#include "equidem/assembly/power_cells.hpp"
#include "equidem/assembly/voids.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"

#include "support/catch.hpp"
#include "support/free_samples.hpp"
#include "triangulated_samples.hpp"

using namespace equidem;
using equidem::test::placed;
using equidem::test::Placement;

namespace {

/// Area of the smallest rectangle with a side along a direction.
double area_along(const Assembly& a, double angle) {
  const Vec2 along = {std::cos(angle), std::sin(angle)};
  Vec2 low = {1e300, 1e300}, high = {-1e300, -1e300};
  for (std::size_t d = 0; d < a.size(); ++d) {
    const Vec2 x = {dot(along, a.centres[d]), cross(along, a.centres[d])};
    const double r = a.radii[d];
    low = {std::min(low.x, x.x - r), std::min(low.y, x.y - r)};
    high = {std::max(high.x, x.x + r), std::max(high.y, x.y + r)};
  }
  return (high.x - low.x) * (high.y - low.y);
}

/// The least area of all directions, by trying many and then more around the best.
double least_area_by_search(const Assembly& a) {
  double best = area_along(a, 0), at = 0, step = 1e-3;
  for (double angle = 0; angle < std::numbers::pi / 2; angle += step)
    if (const double area = area_along(a, angle); area < best) best = area, at = angle;
  for (; step > 1e-12; step /= 10) {
    const double middle = at;
    for (int k = -20; k <= 20; ++k)
      if (const double area = area_along(a, middle + 0.1 * k * step); area < best)
        best = area, at = middle + 0.1 * k * step;
  }
  return best;
}

double sum_of_areas(const Assembly& a) {
  return sum(a.cell_areas);
}

/// What round-off of the coordinates, which `moved` makes coarse, may do to an area.
double rounding_of(const Assembly& a) {
  const Vec2 size = a.box->size();
  double furthest = 0;
  for (const Vec2 x : a.centres) furthest = std::max({furthest, std::abs(x.x), std::abs(x.y)});
  const double shorter = std::min(size.x, size.y), longer = std::max(size.x, size.y);
  return std::numeric_limits<double>::epsilon() * (longer + furthest) / shorter;
}

std::vector<double> ascending(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values;
}

double room_at(const Assembly& assembly, Vec2 place) {
  double room = 1e300;
  const Vec2 period = assembly.period.value_or(Vec2{});
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x)
      for (std::size_t d = 0; d < assembly.size(); ++d)
        room = std::min(room, norm(assembly.centres[d] + Vec2{x * period.x, y * period.y} - place) - assembly.radii[d]);
  return room;
}

}  // namespace

TEST_CASE("no_direction_has_a_smaller_rectangle_than_the_least_and_it_holds_all_discs") {
  for (std::uint64_t number = 0; number < 60; ++number) {
    const Assembly a = placed(test::free_sample(number), {.degrees = 17.0 * static_cast<double>(number), .moved = {}});
    const TurnedRectangle box = least_rectangle(a.centres, a.radii);
    const double searched = least_area_by_search(a);
    CAPTURE(number, a.size(), box.area(), searched, box.along.x, box.along.y);
    CHECK(box.area() <= searched * (1 + 1e-13));
    CHECK(box.area() >= searched * (1 - 1e-6));
    CHECK(norm(box.along) == Approx(1).epsilon(1e-15));
    for (std::size_t d = 0; d < a.size(); ++d) {
      const Vec2 from_low = box.seen(a.centres[d] - box.low), to_high = box.seen(box.high - a.centres[d]);
      CHECK(std::min({from_low.x, from_low.y, to_high.x, to_high.y}) >= a.radii[d] * (1 - 1e-12) - 1e-13);
    }
  }
}

TEST_CASE("a_heap_has_the_rectangle_that_stands_on_its_base") {
  // Report 01: three rectangles are of equal area.
  Assembly heap = test::rows_of_discs(7, 7, 1);
  measure_cells(heap);
  CHECK(heap.box->upright());
  CHECK(heap.area() == Approx(7 * (3 * std::numbers::sqrt3 + 1)).epsilon(1e-14));
}

TEST_CASE("cells_of_a_free_sample_are_those_of_a_polygon_cut_by_every_other_disc_and_fill_its_region") {
  double worst = 0, most_unfilled = 0;
  for (std::uint64_t number = 0; number < 200; ++number) {
    Random random(1000 + number);
    const Placement placement{.degrees = random.uniform(0, 360), .mirrored = number % 2 == 0, .moved = {}};
    Assembly a = placed(test::free_sample(number), placement);
    measure_cells(a);
    const double unfilled = std::abs(sum_of_areas(a) / a.box->area() - 1);
    most_unfilled = std::max(most_unfilled, unfilled);
    const oracle::Cells cells = oracle::cells(a, *a.box, 0);
    double error = 0;
    for (std::size_t d = 0; d < a.size(); ++d)
      error = std::max(error, std::abs(cells.areas[d] - a.cell_areas[d]) / a.box->area());
    worst = std::max(worst, error);
    CAPTURE(number, a.size(), unfilled, error, placement.name());
    CHECK(unfilled < 1e-12);
    CHECK(error < 1e-12 * static_cast<double>(a.size()));

    std::vector<double> facets, of_oracle;
    for (const double length : power_cells(a).facet_lengths) facets.push_back(length);
    for (const oracle::Neighbour& neighbour : cells.neighbours) of_oracle.push_back(neighbour.facet);
    // Facets about as short as those that are left out may be in one of the two lists.
    const auto short_facet = [&](double length) { return length < 1e-8; };
    std::erase_if(facets, short_facet), std::erase_if(of_oracle, short_facet);
    facets = ascending(facets), of_oracle = ascending(of_oracle);
    REQUIRE(facets.size() == of_oracle.size());
    for (std::size_t k = 0; k < facets.size(); ++k)
      CHECK(std::abs(facets[k] - of_oracle[k]) < 1e-9 * norm(a.box->size()));
  }
  CAPTURE(worst, most_unfilled);
  SUCCEED();
}

TEST_CASE("region_and_cells_do_not_depend_on_how_a_sample_lies") {
  for (std::uint64_t number = 0; number < 200; ++number) {
    const Assembly sample = test::free_sample(number);
    Assembly as_it_lies = sample;
    measure_cells(as_it_lies);
    const std::vector<double> areas = ascending(as_it_lies.cell_areas);
    for (const Placement& placement :
         {Placement{.degrees = 13, .moved = {}}, Placement{.degrees = 30, .moved = {}},
          Placement{.degrees = 45, .mirrored = true, .moved = {}}, Placement{.degrees = 77, .moved = {300, -200}},
          Placement{.degrees = 90, .moved = {}, .unit = 1e-3}, Placement{.mirrored = true, .moved = {1e5, 2e5}}}) {
      Assembly other = placed(sample, placement);
      measure_cells(other);
      const double unit = placement.unit * placement.unit, close = 16 * rounding_of(other) + 1e-13;
      CAPTURE(number, sample.size(), placement.name(), close, other.area() / unit, as_it_lies.area());
      CHECK(std::abs(other.area() / unit / as_it_lies.area() - 1) < close);
      CHECK(std::abs(other.solid_fraction() / as_it_lies.solid_fraction() - 1) < close);
      CHECK(std::abs(sum_of_areas(other) / other.box->area() - 1) < 1e-12);
      const std::vector<double> others = ascending(other.cell_areas);
      // A cell changes with the place of its corners, the more the flatter the triangle of which they are centres.
      double change = 0;
      for (std::size_t d = 0; d < areas.size(); ++d)
        change = std::max(change, std::abs(others[d] / unit - areas[d]) / as_it_lies.area());
      CHECK(change < 1e3 * close);
    }
  }
}

TEST_CASE("the_order_of_the_discs_does_not_change_the_region") {
  for (std::uint64_t number = 0; number < 40; ++number) {
    Assembly a = placed(test::free_sample(number), {.degrees = 31, .moved = {}});
    const TurnedRectangle box = least_rectangle(a.centres, a.radii);
    std::reverse(a.centres.begin(), a.centres.end());
    std::reverse(a.radii.begin(), a.radii.end());
    const TurnedRectangle other = least_rectangle(a.centres, a.radii);
    CAPTURE(number, box.area(), other.area());
    CHECK(other.area() == Approx(box.area()).epsilon(1e-14));
  }
}

TEST_CASE("the_sides_of_a_turned_region_are_shared_by_the_cells_in_full") {
  for (std::uint64_t number = 0; number < 60; ++number) {
    Assembly a = placed(test::free_sample(number), {.degrees = 20, .moved = {}});
    const Vec2 size = region_of_cells(a).size();
    CAPTURE(number, a.size());
    Vec2 closed;
    std::size_t k = 0;
    for (const RegionSide& side : region_sides(a)) {
      const double length = sum(side.discs.tributary_lengths);
      CHECK(length == Approx(k++ % 2 == 0 ? size.x : size.y).epsilon(1e-9));
      closed += length * side.outward;
    }
    CHECK(norm(closed) < 1e-8 * norm(size));
  }
}

TEST_CASE("a_box_that_is_turned_keeps_its_place") {
  Assembly a = test::rows_of_discs(3, 1, 0);
  const Vec2 along = {0.8, 0.6};
  a = placed(a, {.degrees = std::atan2(0.6, 0.8) * 180 / std::numbers::pi, .moved = {}});
  a.box = TurnedRectangle({-2 * along - perpendicular(along), 2 * along + perpendicular(along)}, along);
  measure_cells(a);
  CHECK(a.area() == Approx(8).epsilon(1e-14));
  CHECK(a.cell_areas[1] == Approx(2).epsilon(1e-14));
  CHECK(a.cell_areas[0] == Approx(3).epsilon(1e-14));
  const auto refusal = [&](TurnedRectangle box) {
    Assembly bad = a;
    bad.box = box;
    try {
      check(bad), measure_cells(bad);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("(accepted)");
  };
  CHECK(refusal(*a.box) == "(accepted)");
  CHECK_THAT(refusal(TurnedRectangle(*a.box, {0.8, 0.7})), Catch::Contains("length 1"));
  CHECK_THAT(refusal(TurnedRectangle({a.box->low, a.box->low + 2 * along + 2 * perpendicular(along)}, along)),
             Catch::Contains("lies outside"));
}

TEST_CASE("the_void_between_three_touching_discs_is_that_of_soddy") {
  const Assembly block = hexagonal_lattice({.columns = 5, .rows = 5, .radius = 0.5});
  const auto found = largest_void(block);
  REQUIRE(found);
  CHECK(found->radius == Approx(0.5 * (2 / std::sqrt(3.0) - 1)).epsilon(1e-9));
}

TEST_CASE("no_place_on_a_grid_has_more_room_than_the_largest_void") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    Assembly cell;
    cell.period = Vec2{2.0, 1.0};
    while (cell.size() < 60) {
      const Vec2 place{random.uniform(0, 2), random.uniform(0, 1)};
      const double radius = random.uniform(0.03, 0.06);
      if (cell.size() > 0 && room_at(cell, place) < radius) continue;
      cell.centres.push_back(place);
      cell.radii.push_back(radius);
    }
    const auto found = largest_void(cell);
    REQUIRE(found);
    double most = 0;
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 200; ++x) most = std::max(most, room_at(cell, {0.01 * x, 0.01 * y}));
    CAPTURE(seed, most, found->radius);
    CHECK(room_at(cell, found->centre) == Approx(found->radius).epsilon(1e-9));
    CHECK(most <= found->radius * (1 + 1e-9));
    CHECK(most > 0.9 * found->radius);
  }
}

TEST_CASE("two_discs_have_no_void_between_them") {
  Assembly pair;
  pair.centres = {{0, 0}, {3, 0}};
  pair.radii = {1, 1};
  CHECK_FALSE(largest_void(pair));
}
