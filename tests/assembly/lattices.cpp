// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/lattices.hpp"

#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"

#include "geometry_oracle.hpp"
#include "support/catch.hpp"

using namespace equidem;

namespace {

Assembly lattice(bool hexagonal, const LatticeOptions& options) {
  return hexagonal ? hexagonal_lattice(options) : square_lattice(options);
}

/// Contacts named from one end, as touching_discs names them.
std::multiset<oracle::Pair> named(const std::vector<Contact>& contacts) {
  std::multiset<oracle::Pair> result;
  for (Contact c : contacts) {
    if (std::tuple(c.i, 0, 0) > std::tuple(c.j, c.shift_x, c.shift_y)) {
      c = {.i = c.j, .j = c.i, .shift_x = -c.shift_x, .shift_y = -c.shift_y};
    }
    result.insert(oracle::pair(c));
  }
  return result;
}

double total(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

TEST_CASE("lattice_contacts_are_the_touching_discs_each_once") {
  const bool hexagonal = GENERATE(true, false);
  const bool periodic = GENERATE(true, false);
  const int columns = GENERATE(1, 2, 3, 5, 8);
  const int rows = GENERATE(1, 2, 3, 4, 6);
  if (hexagonal && periodic && rows % 2 != 0) return;
  if (hexagonal && !periodic && columns == 1 && rows > 1) return;
  CAPTURE(hexagonal, periodic, columns, rows);

  const Assembly assembly = lattice(hexagonal, {.columns = columns, .rows = rows, .radius = 0.3, .periodic = periodic});

  check(assembly);
  CHECK(named(assembly.contacts) == named(touching_discs(assembly)));
  for (const Contact& c : assembly.contacts) {
    CHECK(norm(assembly.branch(c)) == Approx(0.6).epsilon(1e-14));
    CHECK(c.lever_i == 0.3);
    CHECK(c.lever_j == 0.3);
  }
  for (std::size_t k = 1; k < assembly.contacts.size(); ++k) {
    CHECK(assembly.contacts[k - 1].i <= assembly.contacts[k].i);
  }
}

TEST_CASE("lattice_counts_follow_their_formulas") {
  const int c = GENERATE(2, 3, 7, 10);
  const int r = GENERATE(2, 4, 7, 9);
  CAPTURE(c, r);
  const auto discs = [&](const Assembly& a) { return static_cast<int>(a.size()); };
  const auto contacts = [&](const Assembly& a) { return static_cast<int>(a.contacts.size()); };

  const Assembly block = hexagonal_lattice({.columns = c, .rows = r});
  const int short_rows = r / 2;
  CHECK(discs(block) == c * r - short_rows);
  // Along the rows, and two for every disc of a short row with each row beside it: 2 (c - 1) between two
  // rows.
  CHECK(contacts(block) == (c - 1) * r - short_rows + 2 * (c - 1) * (r - 1));

  const Assembly grid = square_lattice({.columns = c, .rows = r});
  CHECK(discs(grid) == c * r);
  CHECK(contacts(grid) == (c - 1) * r + c * (r - 1));

  CHECK(square_lattice({.columns = c, .rows = r, .periodic = true}).coordination_number() == 4);
  if (r % 2 == 0) CHECK(hexagonal_lattice({.columns = c, .rows = r, .periodic = true}).coordination_number() == 6);
}

TEST_CASE("lattice_areas_give_the_solid_fractions_of_close_and_square_packing") {
  const bool periodic = GENERATE(true, false);
  const LatticeOptions options = {.columns = 6, .rows = 4, .radius = 0.02, .periodic = periodic};
  const double pi = std::numbers::pi;

  CHECK(hexagonal_lattice(options).solid_fraction() == Approx(pi / (2 * std::sqrt(3.0))).epsilon(1e-13));
  CHECK(square_lattice(options).solid_fraction() == Approx(pi / 4).epsilon(1e-13));
}

TEST_CASE("measured_cells_of_a_periodic_lattice_are_those_it_states") {
  const bool hexagonal = GENERATE(true, false);
  const int columns = GENERATE(1, 2, 5);
  const Assembly stated = lattice(hexagonal, {.columns = columns, .rows = 4, .periodic = true});
  CAPTURE(hexagonal, columns);

  Assembly measured = stated;
  measure_cells(measured);

  for (std::size_t d = 0; d < stated.size(); ++d) {
    CHECK(measured.cell_areas[d] == Approx(stated.cell_areas[d]).epsilon(1e-12));
  }
  for (std::size_t k = 0; k < stated.contacts.size(); ++k) {
    CHECK(measured.facet_lengths[k] == Approx(stated.facet_lengths[k]).epsilon(1e-12));
  }
}

TEST_CASE("sides_of_a_free_lattice_are_its_outer_discs") {
  const bool hexagonal = GENERATE(true, false);
  const int rows = GENERATE(1, 4, 5);
  const double a = 0.5;
  const Assembly assembly = lattice(hexagonal, {.columns = 6, .rows = rows, .radius = a});
  CAPTURE(hexagonal, rows);
  const double row_distance = (hexagonal ? std::sqrt(3.0) : 2) * a;

  const auto left = group(assembly, "left");
  const auto top = group(assembly, "top");
  CHECK(left.discs.size() == static_cast<std::size_t>(rows));
  CHECK(total(left.tributary_lengths) == Approx(rows * row_distance));
  CHECK(total(group(assembly, "right").tributary_lengths) == Approx(rows * row_distance));
  CHECK(total(group(assembly, "bottom").tributary_lengths) == Approx(6 * 2 * a));
  CHECK(top.discs.size() == (hexagonal && rows % 2 == 0 ? 5 : 6));
  for (const char* corner : {"bottom_left", "bottom_right", "top_left", "top_right"}) {
    CHECK(group(assembly, corner).discs.size() == 1);
  }
  for (const std::int32_t disc : left.discs) CHECK(assembly.centres[disc].x <= 2 * a);
  for (const std::int32_t disc : top.discs) CHECK(assembly.centres[disc].y == assembly.centres.back().y);
  CHECK(group(assembly, "top_right").discs[0] == static_cast<std::int32_t>(assembly.size()) - 1);
  CHECK(group(assembly, "bottom_left").discs[0] == 0);
}

TEST_CASE("a_lattice_is_one_whatever_it_is_read_from_and_no_other_assembly_is") {
  const bool hexagonal = GENERATE(true, false), periodic = GENERATE(true, false);
  Assembly assembly = lattice(hexagonal, {.columns = 5, .rows = 6, .radius = 0.02, .periodic = periodic});
  const std::string name = assembly.kind;
  CAPTURE(name, periodic);
  assembly.kind = "file";
  REQUIRE(lattice_of(assembly) != nullptr);
  CHECK(lattice_of(assembly)->name == name);

  Assembly other = assembly;
  other.centres[7].x += 1e-7 * other.radii[7];
  CHECK(lattice_of(other) == nullptr);
  other = assembly;
  other.radii[3] *= 1 - 1e-7;
  CHECK(lattice_of(other) == nullptr);
  other = assembly;
  std::swap(other.centres[7], other.centres[8]);
  CHECK(lattice_of(other) == nullptr);
  other = assembly;
  other.centres.pop_back(), other.radii.pop_back();
  CHECK(lattice_of(other) == nullptr);
  CHECK(lattice_of(Assembly{}) == nullptr);
  if (periodic) other = assembly, other.period->x *= 1.1;
  if (!periodic) other = assembly, other.groups["left"].discs.pop_back();
  CHECK(lattice_of(other) == nullptr);
}

TEST_CASE("lattices_refuse_what_makes_no_lattice") {
  CHECK_THROWS_WITH(hexagonal_lattice({.columns = 0}),
                    "columns = 0 (a row of a lattice has at least one disc). Ask for 1 or more.");
  CHECK_THROWS_WITH(square_lattice({.rows = -3}), "rows = -3 (a lattice has at least one row). Ask for 1 or more.");
  CHECK_THROWS_WITH(square_lattice({.radius = 0}), "radius = 0 m (a radius must be positive and finite). Correct it.");
  CHECK_THROWS_WITH(square_lattice({.radius = NAN}),
                    "radius = nan m (a radius must be positive and finite). Correct it.");
  CHECK_THROWS_WITH(hexagonal_lattice({.rows = 5, .periodic = true}),
                    "rows = 5 in a periodic hexagonal lattice (rows are shifted by turns, so that only an even number "
                    "of them repeats). Ask for 4 or 6.");
  CHECK_THROWS_WITH(hexagonal_lattice({.columns = 1, .rows = 3}),
                    "columns = 1 in a free hexagonal lattice (every other row has one disc less, here none, and the "
                    "rows would not touch). Ask for 2 or more columns.");
  CHECK_THROWS_AS(square_lattice({.columns = 100000, .rows = 100000}), Error);
}
