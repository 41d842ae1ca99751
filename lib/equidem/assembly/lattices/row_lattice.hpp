// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Lattices of rows of touching discs, in line or staggered.
#pragma once

#include "equidem/assembly/lattices/lattice.hpp"

namespace equidem {

struct RowPattern {
  const char* kind;
  bool staggered;       ///< every other row is shifted by one radius
  double row_distance;  ///< m
  double cell_area;     ///< m², of a disc
  double facet_length;  ///< m, of a contact
};

/// Discs are numbered row by row. Groups of a free block: left, right (end discs of every row; tributary length the
/// row distance), bottom, top (first and last row; 2a), bottom_left, bottom_right, top_left, top_right (one disc each).
/// \throws Error (bad_input) on counts or a radius that make no lattice, odd `rows` of a periodic staggered lattice
Assembly row_lattice(const LatticeOptions& options, const RowPattern& pattern);

}  // namespace equidem
