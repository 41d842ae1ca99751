// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/strips.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
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

}  // namespace

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

TEST_CASE("the_strips_of_a_periodic_cell_have_its_contacts_and_cells_once") {
  for (const double largest : {0.005, 0.011}) {
    Assembly cell = delaunay_assembly(
        {.discs = 700, .seed = 3, .radii = {.smallest = 0.005, .largest = largest}, .aspect = 1.7, .periodic = true});
    const PowerCells whole = power_cells(cell);
    constexpr std::size_t strips = 4;
    std::vector<Contact> contacts;
    std::vector<double> lengths;
    double worst = 0;
    for (std::size_t strip = 0; strip < strips; ++strip) {
      // Margins of 4 spacings suffice here, so that processes need not agree about anything.
      const StripShare share{.strip = strip,
                             .count = strips,
                             .any = [](bool holds) { return holds; },
                             .joined = [](const std::vector<std::int32_t>& numbers) { return numbers; }};
      const StripCells found = strip_cells(cell, {{0, 0}, *cell.period}, share);
      contacts.insert(contacts.end(), found.cells.neighbours.begin(), found.cells.neighbours.end());
      lengths.insert(lengths.end(), found.cells.facet_lengths.begin(), found.cells.facet_lengths.end());
      std::vector<int> degree(cell.size(), 0);
      for (const Contact& contact : whole.neighbours) ++degree[contact.i], ++degree[contact.j];
      for (std::size_t d = 0; d < cell.size(); ++d) {
        if (found.strips[d] != static_cast<std::int32_t>(strip)) continue;
        worst = std::max(worst, std::abs(found.cells.areas[d] / whole.areas[d] - 1));
        CHECK(found.contacts[d] == degree[d]);
      }
    }
    CAPTURE(largest, worst);
    CHECK(worst < 1e-12);
    REQUIRE(contacts.size() == whole.neighbours.size());
    const auto key = [](const Contact& c) { return std::tuple(c.i, c.j, c.shift_x, c.shift_y); };
    std::vector<std::size_t> order(contacts.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::ranges::sort(order, {}, [&](std::size_t k) { return key(contacts[k]); });
    for (std::size_t k = 0; k < order.size(); ++k) {
      REQUIRE(key(contacts[order[k]]) == key(whole.neighbours[k]));
      CHECK(std::abs(lengths[order[k]] - whole.facet_lengths[k]) <= 1e-12 * 0.005);
    }
  }
}
