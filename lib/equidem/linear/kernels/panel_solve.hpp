// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Triangular solutions with the panel of one front: most fronts have fewer than a hundred rows, where calls of BLAS
/// cost more than the arithmetic.
#pragma once

#include <cstddef>
#include <cstring>

namespace equidem {

/// 32 bytes of numbers: two vectors where the processor has only those of 16.
typedef double PanelLanes __attribute__((vector_size(32)));  // NOLINT(modernize-use-using): attribute of a typedef

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors are passed between inlined functions only
inline __attribute__((always_inline)) PanelLanes load_lanes(const double* from) {
  PanelLanes v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
inline __attribute__((always_inline)) void store_lanes(double* to, const PanelLanes& v) {
  std::memcpy(to, &v, sizeof v);
}
#pragma GCC diagnostic pop

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
