// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Regular assemblies of equal touching discs.
#pragma once

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// A block of a lattice. Rows run along x, the first at the bottom.
struct LatticeOptions {
  int columns = 21;       ///< discs in a row, >= 1
  int rows = 21;          ///< >= 1
  double radius = 0.005;  ///< m, > 0
  bool periodic = false;  ///< in both directions
};

/// Close-packed rows (Abe 1996, Figs. 5 and 6). Free: rows alternate `columns` and `columns - 1` discs, the first and
/// every other one long, each short row shifted by one radius. Periodic: `columns` discs in each row, `rows` even.
/// Every disc stands for the area 2 sqrt3 a²; the height of a free block is rows * sqrt3 a. Groups of a free block:
/// left, right (end discs of every row), bottom, top (first and last row), bottom_left, bottom_right, top_left,
/// top_right (one disc each); tributary lengths sqrt3 a on left and right, 2a on bottom and top.
/// \throws Error (bad_input) on counts or a radius that make no lattice, odd `rows` where periodic
Assembly hexagonal_lattice(const LatticeOptions& options);

/// Discs on a square grid (Abe 1996, Fig. 4); groups as for the hexagonal lattice, tributary lengths 2a.
Assembly square_lattice(const LatticeOptions& options);

}  // namespace equidem
