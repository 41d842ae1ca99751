// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The solver of networks that break, where it is left to the program.
#pragma once

#include "equidem/linear/linear_solver.hpp"

namespace equidem {

/// With a method and a precision where they are left to the library: a factor in double precision, which alone tells
/// the stability of each network and can be updated.
inline SolverOptions factor_to_update(SolverOptions options) {
  if (options.method == SolverMethod::automatic) options.method = SolverMethod::multifrontal;
  if (options.precision == FactorPrecision::automatic) options.precision = FactorPrecision::double_precision;
  return options;
}

}  // namespace equidem
