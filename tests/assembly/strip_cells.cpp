// SPDX-License-Identifier: GPL-3.0-or-later
// The cells of one strip for each process.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/power_cells.hpp"

#include "support/catch.hpp"

namespace {

using namespace equidem;

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

TEST_CASE("one_strip_is_the_whole_assembly") {
  const DelaunayOptions options{.discs = 500, .points = PointProcess::uniform, .seed = 5};
  const StripShare share{.strip = 0,
                         .count = 1,
                         .any = [](bool holds) { return holds; },
                         .joined = [](const std::vector<std::int32_t>& numbers) { return numbers; }};
  const Assembly whole = delaunay_assembly(options);
  const Assembly one = delaunay_strip(options, share).assembly;
  REQUIRE(one.size() == whole.size());
  REQUIRE(one.contacts.size() == whole.contacts.size());
  for (std::size_t c = 0; c < whole.contacts.size(); ++c) {
    CHECK(std::tuple(one.contacts[c].i, one.contacts[c].j) == std::tuple(whole.contacts[c].i, whole.contacts[c].j));
  }
  for (std::size_t d = 0; d < whole.size(); ++d)
    CHECK(std::abs(one.cell_areas[d] - whole.cell_areas[d]) <= 1e-12 * whole.cell_areas[d]);
  for (const auto& [name, group] : whole.groups) CHECK(one.groups.at(name).discs == group.discs);
}

}  // namespace
