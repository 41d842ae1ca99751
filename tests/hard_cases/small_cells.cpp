// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cells and assemblies of a few discs, where discs touch themselves and each other more than once.
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"

#include "hard_cases/ledger.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

double difference(const Matrix3& a, const Matrix3& b) {
  return largest_entry(a + (-1.0) * b) / largest_entry(b);
}

void check_small_cells(HardCase& table, double ratio, Rotation rotation) {
  const ContactSprings k(SpringConstants{1e9, ratio * 1e9});
  for (int discs = 1; discs <= 3; ++discs) {
    if (ratio < 0 && discs == 1) continue;  // two contacts around one disc: the square network, unstable for kT < 0
    for (const std::uint64_t seed : {1, 2, 3}) {
      const Assembly cell =
          delaunay_assembly({.discs = discs, .points = PointProcess::uniform, .seed = seed, .periodic = true});
      CAPTURE(discs, seed, cell.size(), cell.contacts.size());
      table.right("homogenize", homogenize(cell, k, rotation), 1e-12);
    }
  }
  for (const int columns : {1, 3}) {
    if (ratio < 0) continue;
    const Assembly square = square_lattice({.columns = columns, .rows = 1, .periodic = true});
    const Matrix3 exact{{{1e9, 0, 0}, {0, 1e9, 0}, {0, 0, ratio * 0.5e9}}};  // F2
    table.right("homogenize", homogenize(square, k, rotation, exact), 1e-13);
  }
  const Assembly hexagonal = hexagonal_lattice({.columns = 1, .rows = 2, .periodic = true});
  const double root = 0.86602540378443865;
  const Matrix3 exact = isotropic_stiffness(root * 1e9, root / 2 * (1 + ratio) * 1e9);  // F1
  table.right("homogenize", homogenize(hexagonal, k, rotation, exact), 1e-13);
}

}  // namespace

TEST_CASE("cells_of_one_two_and_three_discs_are_right") {
  HardCase table({.name = "a cell of one, two, three discs",
                  .why = "discs touch their own images through the period, and one neighbour several times"});
  for (const double ratio : {0.4, 1.0, -0.02}) {
    for (const Rotation rotation : {Rotation::from_scene, Rotation::restrained}) {
      CAPTURE(ratio, rotation == Rotation::restrained);
      check_small_cells(table, ratio, rotation);
    }
  }
}

TEST_CASE("two_discs_that_touch_twice_are_right_or_named") {
  HardCase table(
      {.name = "two discs touching twice",
       .why =
           "two blocks of K fall on one another; the ring of two contacts is even, and closes only for equal levers"});
  Assembly pair = chain_of_discs(2, 0.5);
  pair.contacts.push_back(pair.contacts[0]);
  const std::vector<Support> held{{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = 0.0},
                                  {.group = "last", .ux = {}, .uy = 0.0, .rotation = {}}};
  const LoadCase loads{{.group = "last", .kind = LoadKind::total, .force = {1000, 0}, .moment = 7}};
  table.right("solve", solve({pair, usual_springs, held, loads}), 1e-13);
  const Equilibrium state = solve_equilibrium(pair, usual_springs, held, loads);
  CHECK(state.motions[1].u.x == Approx(1000 / 2e9).epsilon(1e-14));
  CHECK(state.motions[1].theta == Approx(7 / (2 * 0.4e9 * 0.25)).epsilon(1e-14));

  const std::vector<Support> pinned{{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = {}},
                                    {.group = "last", .ux = {}, .uy = 0.0, .rotation = {}}};
  table.refused("solve, rotations free", solve({pair, usual_springs, pinned, loads}),
                {"gears", "odd ring", "Hold the rotation"});
  pair.contacts[0].lever_i = 0.3, pair.contacts[0].lever_j = 0.7;  // turns 7:3 at one contact, 1:1 at the other
  table.right("solve, levers that differ", solve({pair, usual_springs, pinned, loads}), 1e-12);

  Assembly cell = delaunay_assembly({.discs = 2, .points = PointProcess::uniform, .seed = 4, .periodic = true});
  const Matrix3 once = effective_stiffness(cell, ContactSprings(SpringConstants{2e9, 0.8e9})).stiffness;
  const std::vector<Contact> contacts = cell.contacts;
  cell.contacts.insert(cell.contacts.end(), contacts.begin(), contacts.end());
  cell.facet_lengths.clear();
  table.right("homogenize", homogenize(cell, usual_springs), 1e-13);
  CHECK(difference(effective_stiffness(cell, usual_springs).stiffness, once) < 1e-14);
}
