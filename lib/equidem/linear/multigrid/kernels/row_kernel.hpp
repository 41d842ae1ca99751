// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Products with the rows of GroupedRows, compiled for the vectors that the processor has.
#pragma once

#include <cstddef>

#include "equidem/linear/multigrid/grouped_rows.hpp"

namespace equidem::multigrid {

/// Functions over the groups [first, last), as GroupedRows has them over rows.
struct RowFunctions {
  void (*start)(const GroupedRows& rows, std::size_t first, std::size_t last, float factor, const Quad* b, Quad* x);
  void (*advance)(const GroupedRows& rows, std::size_t first, std::size_t last, const ChebyshevStep& step,
                  const Quad* b, const Quad* x, Quad* next);
  void (*residual)(const GroupedRows& rows, std::size_t first, std::size_t last, const Quad* b, const Quad* x, Quad* r);
  double (*multiply)(const GroupedRows& rows, std::size_t first, std::size_t last, const double* p, double* q);
};

const RowFunctions& row_functions(const RowKind& kind);

}  // namespace equidem::multigrid
