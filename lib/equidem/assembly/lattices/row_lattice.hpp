// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Lattices of rows of touching discs, in line or staggered.
#pragma once

#include <array>
#include <cstdint>

#include "equidem/assembly/lattices/lattice.hpp"

namespace equidem {

/// The places, numbers and neighbours of the discs of such a lattice by formula: any part of it can be made without the
/// rest. Discs are numbered row by row from 0.
class RowLattice {
 public:
  /// A contact of a disc with another one, whose place may lie across the period.
  struct Neighbour {
    int row, column;
    int shift_x, shift_y;
  };
  /// The contacts that start at a disc: one to the right, others to the next row.
  struct Neighbours {
    std::array<Neighbour, 3> of;
    int count = 0;
  };

  RowLattice(const LatticeOptions& options, const RowPattern& pattern) : options_(options), pattern_(pattern) {}

  [[nodiscard]] const LatticeOptions& options() const { return options_; }
  [[nodiscard]] const RowPattern& pattern() const { return pattern_; }
  [[nodiscard]] bool shifted(int row) const { return pattern_.staggered && row % 2 != 0; }
  /// Discs in a row.
  [[nodiscard]] int count(int row) const {
    return shifted(row) && !options_.periodic ? options_.columns - 1 : options_.columns;
  }
  /// Number of the first disc of a row; of the row behind the last one: of all discs.
  [[nodiscard]] std::int64_t first(int row) const {
    const int short_rows = pattern_.staggered && !options_.periodic ? row / 2 : 0;
    return std::int64_t{options_.columns} * row - short_rows;
  }
  [[nodiscard]] Vec2 centre(int row, int column) const {
    const double half_diameters = 2.0 * column + (shifted(row) ? 2 : 1);
    return {half_diameters * options_.radius, (row + 0.5) * pattern_.row_distance};
  }
  /// m, of a periodic lattice.
  [[nodiscard]] Vec2 period() const {
    return {2.0 * options_.columns * options_.radius, options_.rows * pattern_.row_distance};
  }
  /// Every contact starts at one of its two discs, so that each is made once.
  [[nodiscard]] Neighbours neighbours(int row, int column) const;

 private:
  LatticeOptions options_;
  RowPattern pattern_;
};

/// \throws Error (bad_input) as row_lattice, but for the number of discs and their memory
void check_row_lattice(const LatticeOptions& options, const RowPattern& pattern);

/// The groups of a free lattice that row_lattice makes, with the numbers of the discs in the whole lattice.
/// \throws Error (bad_input) where these exceed 2^31 - 1
std::map<std::string, DiscGroup> row_lattice_sides(const RowLattice& lattice);

/// Discs are numbered row by row. Groups of a free block: left, right (end discs of every row; tributary length the
/// row distance), bottom, top (first and last row; 2a), bottom_left, bottom_right, top_left, top_right (one disc each).
/// \throws Error (bad_input) on counts or a radius that make no lattice, odd `rows` of a periodic staggered lattice
Assembly row_lattice(const LatticeOptions& options, const RowPattern& pattern);

/// Whether row_lattice makes these centres (to 1e-9 of a radius), radii and sides in this order.
bool is_row_lattice(const Assembly& assembly, const RowPattern& pattern);

}  // namespace equidem
