// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/strips.hpp"

#include <numeric>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/power_cells.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/threads.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr std::int64_t many = 120000;  // enough for two strips

/// Independent points in a rectangle of the aspect 3, of unequal radii.
Assembly scattered(bool periodic, double hole = 0) {
  Random random(7);
  Assembly assembly;
  const Vec2 extent = {600, 200}, centre = 0.5 * extent;
  for (std::int64_t k = 0; k < many; ++k) {
    const Vec2 x = {random.uniform(0, extent.x), random.uniform(0, extent.y)};
    const double radius = random.uniform(0.3, 0.6);
    if (norm(x - centre) < hole) continue;
    assembly.centres.push_back(x);
    assembly.radii.push_back(radius);
  }
  if (periodic) {
    assembly.period = extent;
  } else {
    assembly.box = Rectangle{.low = {0, 0}, .high = extent};
  }
  return assembly;
}

bool same(const TriangulationEdge& p, const TriangulationEdge& q) {
  return p.a == q.a && p.b == q.b && p.left == q.left && p.right == q.right;
}

}  // namespace

TEST_CASE("strips_give_the_edges_of_one_triangulation") {
  const Sites sites(scattered(true));
  Strips strips(sites);
  REQUIRE(strips.count() > 1);
  const std::vector<TriangulationEdge> parts = strips.edges();
  strips.join();
  const std::vector<TriangulationEdge> whole = strips.edges();

  // Edges that start at an image may lie at the edge of all images, where strips differ.
  std::size_t compared = 0, different = 0;
  for (std::size_t p = 0, w = 0; p < parts.size() && w < whole.size(); ++p, ++w) {
    if (!sites.in_cell(parts[p].a) || !sites.in_cell(whole[w].a)) break;
    ++compared;
    different += same(parts[p], whole[w]) ? 0 : 1;
  }
  CHECK(compared > 2 * many);
  CHECK(different == 0);
}

TEST_CASE("cells_fill_the_rectangle_also_around_a_hole_that_is_wider_than_the_margin_of_a_strip") {
  for (const double hole : {0.0, 30.0}) {
    CAPTURE(hole);
    const Assembly assembly = scattered(false, hole);
    const PowerCells cells = power_cells(assembly);
    const double area = std::accumulate(cells.areas.begin(), cells.areas.end(), 0.0);
    CHECK(area == Approx(600.0 * 200.0).epsilon(1e-12));
  }
}

TEST_CASE("many_discs_are_the_same_for_every_number_of_threads") {
  const auto made = [](int threads) {
    set_thread_count(threads);
    Assembly assembly = delaunay_assembly({.discs = many, .seed = 3});
    set_thread_count(1);
    return assembly;
  };
  const Assembly one = made(1), three = made(3);
  CHECK(one.centres == three.centres);
  CHECK(one.cell_areas == three.cell_areas);
  CHECK(one.facet_lengths == three.facet_lengths);
  CHECK(one.groups.at("left").tributary_lengths == three.groups.at("left").tributary_lengths);
}

TEST_CASE("sides_are_measured_without_a_triangulation") {
  for (const std::int64_t discs : {3, 20, 500, 5000}) {
    for (const PointProcess points : {PointProcess::uniform, PointProcess::poisson_disc}) {
      Assembly assembly = delaunay_assembly(
          {.discs = discs, .points = points, .seed = 5, .radii = {.smallest = 0.002, .largest = 0.008}, .aspect = 2});
      assembly.groups.clear();
      const auto sides = measured_sides(assembly);
      measure_cells(assembly);
      CAPTURE(discs, to_string(points));
      REQUIRE(sides.size() == assembly.groups.size());
      for (const auto& [name, side] : assembly.groups) {
        CAPTURE(name);
        CHECK(sides.at(name).discs == side.discs);
        CHECK(sides.at(name).tributary_lengths == side.tributary_lengths);
      }
    }
  }
}
