// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rank-one changes of the columns of L that one front eliminates, with the forward substitution of the new columns.
#pragma once

#include <cstddef>
#include <vector>

namespace equidem {

/// Vectors that change a panel at once, and right-hand sides that are solved beside them.
constexpr std::size_t most_changes = 2, most_right_sides = 2;

/// L_new L_new^T = L L^T + sum sign_k w_k w_k^T on the columns of one front (Gill, Golub, Murray & Saunders 1974,
/// method C1, in the form of Bojanczyk et al. 1987 for differences: the vector is rotated by the new column).
struct PanelChange {
  double* values;  ///< columns of L, column-major: a triangle of `pivots` rows above `rows - pivots` others
  std::size_t pivots;
  std::size_t rows;         ///< also the leading dimension
  double* vectors;          ///< rows x changes: w on input; on output what the rows below the pivots pass on
  const double* signs;      ///< changes: 1 or -1
  std::size_t changes;      ///< <= most_changes
  double* right;            ///< rows x right_sides: y_1 := L_new_11^-1 y_1, y_2 := y_2 - L_new_21 y_1
  std::size_t right_sides;  ///< <= most_right_sides
  /// The square of a pivot that a difference leaves below `least` times the stiffness of that pivot is round-off of
  /// zero. The new matrix is singular there; the stiffness is added to it, which leaves the column no other entries.
  const double* stiffness;  ///< per pivot, > 0
  double least;
};

struct PanelChangeResult {
  std::vector<std::size_t> vanished;  ///< pivots to which their stiffness was added
  double share = 1;                   ///< product of new over old squares of the other pivots
};

/// Pivots that vanish are appended to those of `result`, and its share is multiplied.
void change_panel(const PanelChange& change, PanelChangeResult& result);

}  // namespace equidem
