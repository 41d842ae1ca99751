// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rank-one changes of the columns of L that one front eliminates, with the forward substitution of the new columns.
/// Triangular solutions with the panel of one front: most fronts have fewer than a hundred rows, where calls of BLAS
/// cost more than the arithmetic.
#pragma once

#include <cstddef>
#include <cstring>
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

/// 32 bytes of numbers: two vectors where the processor has only those of 16.
typedef double PanelLanes __attribute__((vector_size(32)));  // NOLINT(modernize-use-using): attribute of a typedef

inline __attribute__((always_inline)) PanelLanes load_lanes(const double* from) {
  PanelLanes v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
inline __attribute__((always_inline)) void store_lanes(double* to, const PanelLanes& v) {
  std::memcpy(to, &v, sizeof v);
}

/// The columns of L that a front eliminates, column-major: a triangle of `pivots` rows above `rows - pivots` others.
struct Panel {
  const double* values;
  std::size_t pivots;
  std::size_t rows;  ///< also the leading dimension
};

/// Right-hand sides that are solved at once.
constexpr std::size_t most_columns = 4;

/// For each column w of `rows` numbers, pivots first: w_1 := L_11^-1 w_1, w_2 := w_2 - L_21 w_1.
/// \param columns <= most_columns
void solve_forward(const Panel& panel, double* w, std::size_t columns);

/// For each column: w_1 := L_11^-T (w_1 - L_21^T w_2).
void solve_backward(const Panel& panel, double* w, std::size_t columns);

}  // namespace equidem
