// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The part of a lattice that a rank makes by itself: a block of rows and columns.
#pragma once

#include "equidem/assembly/lattices/row_lattice.hpp"

#include "petsc/part.hpp"

namespace equidem::petsc {

/// A grid of ranks over the columns and rows of a lattice; blocks are numbered row by row.
class BlockGrid {
 public:
  /// The grid with the shortest cuts.
  /// \throws Error (bad_input) where some rank would have no disc
  BlockGrid(const RowLattice& lattice, int ranks);

  struct Block {
    int first_row, end_row, first_column, end_column;
    /// Columns of the block in a row of the lattice.
    [[nodiscard]] int width(const RowLattice& lattice, int row) const {
      return std::max(0, std::min(end_column, lattice.count(row)) - first_column);
    }
  };
  [[nodiscard]] Block block(int rank) const;
  [[nodiscard]] int rank_of(int row, int column) const;
  /// Discs of a block in the rows from its first one up to `row`.
  [[nodiscard]] std::int64_t discs_below(const Block& block, int row) const;

 private:
  [[nodiscard]] int cut(int count, int parts, int part) const {
    return static_cast<int>(std::int64_t{count} * part / parts);
  }

  const RowLattice& lattice_;
  int across_ = 1;  ///< blocks side by side
  int along_ = 1;   ///< blocks one above the other
};

/// The block of a rank with its ghosts; no rank holds more than that and the sides. Names are the numbers of
/// row_lattice. \throws Error (bad_input) as row_lattice; where there are more ranks than discs
Part lattice_part(const Ranks& ranks, const RowLattice& lattice);

}  // namespace equidem::petsc
