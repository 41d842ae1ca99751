// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The smallest cell is found from any repetition of it.
#include <cmath>

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const ContactSprings unequal_springs(SpringConstants{1, 0.5});

}  // namespace

TEST_CASE("a_lattice_has_one_disc_however_large_the_cell") {
  const auto [columns, rows] =
      GENERATE(std::pair{1, 2}, std::pair{2, 2}, std::pair{3, 4}, std::pair{41, 40}, std::pair{7, 2});
  CAPTURE(columns, rows);
  const PrimitiveCell hexagonal = primitive_cell(periodic_hexagonal(columns, rows), unequal_springs);
  CHECK(hexagonal.size() == 1);
  CHECK(hexagonal.contacts.size() == 3);
  CHECK(hexagonal.copies == columns * rows);
  CHECK(hexagonal.area() == Approx(2 * std::sqrt(3.0)).epsilon(1e-14));
  CHECK(norm(hexagonal.period[0]) == Approx(2).epsilon(1e-14));
  CHECK(dot(hexagonal.period[0], hexagonal.period[1]) == Approx(2).epsilon(1e-13));
  CHECK(brillouin_zone(hexagonal.period).lattice == "hexagonal");

  const PrimitiveCell square = primitive_cell(periodic_square(columns, rows), unequal_springs);
  CHECK(square.size() == 1);
  CHECK(square.contacts.size() == 2);
  CHECK(square.area() == Approx(4).epsilon(1e-14));
  CHECK(brillouin_zone(square.period).lattice == "square");
}

TEST_CASE("a_random_cell_is_its_own_smallest_cell_and_that_of_its_repetitions") {
  const Assembly cell = random_cell(GENERATE(1, 2, 3, 12, 60), 5);
  const auto n = primitive_cell(cell, unequal_springs).size();
  CAPTURE(cell.size(), n);
  if (cell.size() > 3) CHECK(n == cell.size());
  for (const auto& [nx, ny] : {std::pair{2, 1}, std::pair{3, 2}, std::pair{1, 5}}) {
    CAPTURE(nx, ny);
    const PrimitiveCell found = primitive_cell(repeated(cell, nx, ny, 11), unequal_springs);
    CHECK(found.size() == n);
    CHECK(found.area() ==
          Approx(cell.area() * static_cast<double>(n) / static_cast<double>(cell.size())).epsilon(1e-12));
    CHECK(found.contacts.size() * cell.size() == cell.contacts.size() * n);
  }
}

TEST_CASE("what_differs_in_springs_levers_or_radii_does_not_repeat") {
  const Assembly lattice = periodic_hexagonal(4, 4);
  std::vector<SpringConstants> springs(lattice.contacts.size(), {1, 0.5});
  CHECK(primitive_cell(lattice, ContactSprings(springs)).size() == 1);
  springs[7].kT *= 1 + 1e-6;
  CHECK(primitive_cell(lattice, ContactSprings(springs)).size() == lattice.size());

  Assembly levers = lattice;
  levers.contacts[5].lever_i += 1e-6, levers.contacts[5].lever_j -= 1e-6;
  CHECK(primitive_cell(levers, unequal_springs).size() == lattice.size());

  Assembly radii = lattice;
  radii.radii[3] *= 1 + 1e-6;
  CHECK(primitive_cell(radii, unequal_springs).size() == lattice.size());

  Assembly moved = lattice;  // two discs moved alike: half of the period is left, along one direction
  for (const int d : {0, 2}) moved.centres[d].y += 1e-5;
  CHECK(primitive_cell(moved, unequal_springs).size() == lattice.size() / 2);

  Assembly rounded = lattice;  // what a file with 12 digits keeps
  for (Vec2& x : rounded.centres) x = {std::round(x.x * 1e12) / 1e12, std::round(x.y * 1e12) / 1e12};
  CHECK(primitive_cell(rounded, unequal_springs).size() == 1);
}

TEST_CASE("a_free_assembly_has_no_cell") {
  const Refusal refusal = refusal_of([] { primitive_cell(hexagonal_lattice({}), unequal_springs); });
  CAPTURE(refusal.message);
  CHECK(refusal.says("not periodic"));
}

TEST_CASE("the_smallest_cell_of_many_discs_is_found_in_reasonable_time") {
  CHECK(primitive_cell(periodic_hexagonal(200, 200), unequal_springs).size() == 1);
  const Assembly random = random_cell(20000, 3);
  CHECK(primitive_cell(random, unequal_springs).size() == random.size());
}
