// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <set>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/assembly/power_cells.hpp"
#include "equidem/assembly/space_filling_curve.hpp"
#include "equidem/assembly/triangulation.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/threads.hpp"

#include "geometry_oracle.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "triangulated_samples.hpp"

using namespace equidem;

TEST_CASE("the_order_of_the_discs_does_not_change_their_cells") {
  const bool periodic = GENERATE(true, false);
  const auto radii = GENERATE(equal_radii, unequal_radii);
  Assembly a = delaunay_assembly({.discs = 300, .points = PointProcess::uniform, .radii = radii, .periodic = periodic});
  triangulate(a);
  Assembly reversed = a;
  std::reverse(reversed.centres.begin(), reversed.centres.end());
  std::reverse(reversed.radii.begin(), reversed.radii.end());
  triangulate(reversed);

  CHECK(reversed.contacts.size() == a.contacts.size());
  for (std::size_t d = 0; d < a.size(); ++d) {
    CHECK(reversed.cell_areas[a.size() - 1 - d] == Approx(a.cell_areas[d]).epsilon(1e-10));
  }
}

TEST_CASE("corners_where_four_cells_meet_are_no_contacts") {
  // Four discs on every circle: the diagonals of the triangulation have facets of no length.
  const bool periodic = GENERATE(true, false);
  Assembly a;
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 6; ++x) a.centres.push_back({0.5 + x, 0.5 + y});
  }
  a.radii.assign(36, 0.5);
  if (periodic) a.period = Vec2{6, 6};

  triangulate(a);

  CHECK(a.contacts.size() == (periodic ? 72 : 60));
  for (const double f : a.facet_lengths) CHECK(f == Approx(1));
  for (const double area : a.cell_areas) CHECK(area == Approx(1));
  if (periodic) return;
  const DiscGroup left = group(a, "left");
  CHECK(left.discs == std::vector<std::int32_t>{0, 6, 12, 18, 24, 30});
  for (const double length : left.tributary_lengths) CHECK(length == Approx(1));
}

TEST_CASE("a_disc_inside_another_has_an_empty_cell_and_no_contacts") {
  Assembly a;
  a.centres = {{0, 0}, {10, 0}, {10, 10}, {0, 10}, {5, 5}, {5.2, 5.1}};
  a.radii = {1, 1, 1, 1, 4, 0.1};

  triangulate(a);

  CHECK(a.cell_areas[5] == 0);
  for (const Contact& c : a.contacts) CHECK((c.i != 5 && c.j != 5));
  CHECK(sum(a.cell_areas) == Approx(144).epsilon(1e-13));
}

TEST_CASE("cells_of_few_or_collinear_discs_can_be_measured") {
  const int count = GENERATE(1, 2, 5);
  const bool upright = GENERATE(true, false);
  Assembly a;
  for (int k = 0; k < count; ++k) a.centres.push_back(upright ? Vec2{3, 2.0 * k} : Vec2{2.0 * k, 3});
  a.radii.assign(a.size(), 1);
  for (int k = 0; k + 1 < count; ++k) a.contacts.push_back({.i = k + 1, .j = k, .lever_i = 1, .lever_j = 1});
  CAPTURE(count, upright);

  measure_cells(a);

  for (const double area : a.cell_areas) CHECK(area == Approx(4));
  for (const double facet : a.facet_lengths) CHECK(facet == Approx(2));
  CHECK(group(a, upright ? "left" : "bottom").discs.size() == a.size());
  CHECK(group(a, upright ? "bottom" : "left").discs == std::vector<std::int32_t>{0});
}

TEST_CASE("points_that_make_no_triangulation_are_named") {
  Assembly a;
  a.radii.assign(4, 0.1);

  a.centres = {{0, 0}, {1, 0}, {0, 1}, {1, 0}};
  CHECK_THROWS_WITH(triangulate(a),
                    "discs 1 and 3 have the same centre, (1, 0) m (no direction joins them, and their cells cannot be "
                    "separated). Move or remove one of them.");
  a.centres = {{0, 0}, {1, 1}, {3, 3}, {2, 2}};
  CHECK_THROWS_WITH(triangulate(a),
                    "all 4 discs lie on the line through discs 0 and 2 (points on one line have no triangles). Move "
                    "some of them, or list the contacts.");
  a.centres = {{0, 0}, {1, 1}};
  a.radii.resize(2);
  CHECK_THROWS_WITH(triangulate(a),
                    "2 discs cannot be triangulated (a triangulation needs three or more). Add discs, or list the "
                    "contacts.");
  a.period = Vec2{1, 1};
  CHECK_THROWS_WITH(triangulate(a), Catch::Matchers::StartsWith("discs 0 and 1 have the same centre"));
  a.centres = {{0, 0}, {0, 1e-4}};
  a.period = Vec2{1e-9, 1e3};
  test::check_refused([&] { triangulate(a); }, {});
}

TEST_CASE("a_cell_far_longer_than_wide_is_measured_or_refused") {
  Assembly a;
  a.centres = {{0, 0}};
  a.radii = {0.5};
  for (const double length : {1e2, 1e4, 1e5, 1e6, 4294967296.0}) {
    a.period = GENERATE(true, false) ? Vec2{length, 1} : Vec2{1, length};
    const test::Refusal refused = test::refusal_of([&] { measure_cells(a); });
    const bool measured = refused.message.empty();
    CHECK(refused.kind == ErrorKind::bad_input);
    CAPTURE(length, measured);
    CHECK((measured || length > 1e2));
  }
}

TEST_CASE("lengths_whose_squares_leave_the_range_of_a_double_are_refused_and_others_scale_all_cells") {
  const bool periodic = GENERATE(true, false);
  for (const double radius : {1e-160, 1e-71, 1e71, 1e150}) {
    CAPTURE(radius);
    const DelaunayOptions options{
        .discs = 100, .seed = 1, .radii = {.smallest = radius, .largest = radius}, .periodic = periodic};
    CHECK_THROWS_WITH(delaunay_assembly(options), Catch::Contains("it must lie between 1e-70 and 1e+70 m"));
    CHECK_THROWS_WITH(hexagonal_lattice({.columns = 4, .rows = 4, .radius = radius, .periodic = periodic}),
                      Catch::Contains("it must lie between 1e-70 and 1e+70 m"));
  }
  Assembly tiny = hexagonal_lattice({.columns = 4, .rows = 4, .radius = 1, .periodic = true});
  tiny.period->x = 1e-300;
  CHECK_THROWS_WITH(check(tiny), Catch::Matchers::StartsWith("the period is (1e-300, "));
  const auto areas = [](double radius) {
    const Assembly a = delaunay_assembly({.discs = 100, .seed = 1, .radii = {radius, radius}, .periodic = true});
    return std::pair(a.cell_areas, a.contacts.size());
  };
  const auto [known, contacts] = areas(1);
  for (const int power : {-230, -100, 100, 225}) {  // of two, so that nothing is rounded
    CAPTURE(power);
    const auto [found, count] = areas(std::ldexp(1, power));
    REQUIRE(count == contacts);
    for (std::size_t d = 0; d < known.size(); ++d) CHECK(std::ldexp(found[d], -2 * power) == known[d]);
  }
}

TEST_CASE("options_out_of_range_are_refused") {
  CHECK_THROWS_WITH(delaunay_assembly({.discs = 2}),
                    Catch::Matchers::StartsWith("discs = 2 (a free triangulation needs 3"));
  CHECK_THROWS_WITH(delaunay_assembly({.discs = 0, .periodic = true}), Catch::Matchers::StartsWith("discs = 0 ("));
  CHECK_THROWS_WITH(delaunay_assembly({.disorder = 0.5}), Catch::Matchers::StartsWith("disorder = 0.5 ("));
  CHECK_THROWS_WITH(delaunay_assembly({.disorder = NAN}), Catch::Matchers::StartsWith("disorder = nan ("));
  CHECK_THROWS_WITH(delaunay_assembly({.radii = {.smallest = 0}}),
                    Catch::Matchers::StartsWith("the smallest radius is 0 m"));
  CHECK_THROWS_WITH(delaunay_assembly({.radii = {.smallest = 1, .largest = 0.5}}),
                    Catch::Matchers::StartsWith("the largest radius is 0.5 m"));
  CHECK_THROWS_WITH(delaunay_assembly({.aspect = -1}), Catch::Matchers::StartsWith("aspect = -1 ("));
  CHECK_THROWS_WITH(enum_from<PointProcess>("sobol"),
                    "unknown kind of points 'sobol' (it must be \"poisson_disc\", \"perturbed_hexagonal\" or "
                    "\"random\"). Choose one of them.");
  for (const char* name : {"poisson_disc", "perturbed_hexagonal", "random"}) {
    CHECK(to_string(enum_from<PointProcess>(name)) == name);
  }
}
