// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Networks at the onset of rigidity, and points of which four and more lie on every circle.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/mechanisms.hpp"

#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Motions (u_x, u_y of every disc) that stretch no contact: unknowns less the rank of the directions of the contacts,
/// by elimination with the largest pivot of all.
std::int64_t motions_without_stretch(const Assembly& assembly) {
  const std::size_t columns = 2 * assembly.size(), rows = assembly.contacts.size();
  std::vector<double> a(rows * columns, 0.0);
  for (std::size_t c = 0; c < rows; ++c) {
    const Contact& contact = assembly.contacts[c];
    const Vec2 branch = assembly.branch(contact), n = branch / norm(branch);
    a[c * columns + 2 * contact.i] -= n.x, a[c * columns + 2 * contact.i + 1] -= n.y;
    a[c * columns + 2 * contact.j] += n.x, a[c * columns + 2 * contact.j + 1] += n.y;
  }
  std::size_t rank = 0;
  for (; rank < std::min(rows, columns); ++rank) {
    std::size_t row = rank, column = rank;
    for (std::size_t r = rank; r < rows; ++r)
      for (std::size_t c = rank; c < columns; ++c)
        if (std::abs(a[r * columns + c]) > std::abs(a[row * columns + column])) row = r, column = c;
    constexpr double zero = 1e-9;
    if (std::abs(a[row * columns + column]) < zero) break;
    for (std::size_t c = 0; c < columns; ++c) std::swap(a[row * columns + c], a[rank * columns + c]);
    for (std::size_t r = 0; r < rows; ++r) std::swap(a[r * columns + column], a[r * columns + rank]);
    for (std::size_t r = rank + 1; r < rows; ++r) {
      const double factor = a[r * columns + rank] / a[rank * columns + rank];
      if (factor == 0) continue;
      for (std::size_t c = rank; c < columns; ++c) a[r * columns + c] -= factor * a[rank * columns + c];
    }
  }
  return static_cast<std::int64_t>(columns - rank);
}

Assembly square_grid(int n) {
  Assembly grid;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) grid.centres.push_back({0.01 * x + 0.005, 0.01 * y + 0.005});
  grid.radii.assign(grid.centres.size(), 0.005);
  grid.period = Vec2{0.01 * n, 0.01 * n};
  return grid;
}

}  // namespace

TEST_CASE("near_the_onset_of_rigidity_floppy_motions_are_counted_as_the_rank_tells") {
  HardCase table(
      {.name = "bond dilution near p_c = 0.66",
       .why = "a triangular lattice of central springs has as many contacts as it needs at p = 2/3: one contact "
              "decides whether a piece is floppy"});
  const ContactSprings central(SpringConstants{1e9, 0});
  constexpr int cells = 8, n = 10;
  for (const double p : {0.6, 0.64, 0.66, 0.68, 0.72}) {
    int agree = 0, rigid = 0;
    std::int64_t floppy = 0;
    Random random(7);
    for (int k = 0; k < cells; ++k) {
      Assembly cell = hexagonal_lattice({.columns = n, .rows = n, .periodic = true});
      std::erase_if(cell.contacts, [&](const Contact&) { return random.uniform() >= p; });
      cell.facet_lengths.clear();
      const std::int64_t known = motions_without_stretch(cell);
      const MechanismReport found = find_mechanisms(cell, central, Rotation::from_scene, {});
      const std::int64_t counted = found.rigid_motions + found.free_pieces + found.gears + found.others;
      CAPTURE(p, k, known, counted);
      CHECK(counted == known);
      agree += counted == known ? 1 : 0;
      rigid += known == 2 ? 1 : 0;
      floppy += known - 2;
    }
    table.note(fmt::format("stability, {} cells of {} discs, p = {}", cells, n * n, p),
               "motions at no cost as many as by rank",
               fmt::format("{} of {} as by rank; {} rigid, {:.1f} floppy motions in the mean", agree, cells, rigid,
                           static_cast<double>(floppy) / cells));
  }
}

TEST_CASE("points_on_a_square_grid_have_the_contacts_and_the_moduli_of_the_lattice") {
  HardCase table({.name = "cocircular points",
                  .why = "every four neighbours of a square grid lie on one circle: the triangulation may take either "
                         "diagonal, and neither is a contact"});
  const Matrix3 exact{{{1e9, 0, 0}, {0, 1e9, 0}, {0, 0, 0.2e9}}};
  for (const double moved : {0.0, 1e-16, 1e-14}) {  // of the spacing: round-off of other coordinates
    Assembly grid = square_grid(12);
    Random random(3);
    for (Vec2& x : grid.centres) x += 0.01 * moved * Vec2{random.uniform(-1, 1), random.uniform(-1, 1)};
    triangulate(grid);
    CAPTURE(moved, grid.contacts.size());
    CHECK(grid.contacts.size() == 2 * grid.size());
    table.right("homogenize, grid and grid moved by round-off",
                homogenize(grid, usual_springs, Rotation::from_scene, exact), 1e-10);
  }
}
