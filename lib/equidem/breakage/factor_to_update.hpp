// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The solver of networks that break, where it is left to the program.
#pragma once

#include "equidem/linear/linear_solver.hpp"

namespace equidem {

/// The options with a factor that can be updated, in double precision, where method and precision are automatic.
inline SolverOptions factor_to_update(SolverOptions options) {
  if (options.method == SolverMethod::automatic) options.method = SolverMethod::multifrontal;
  if (options.precision == FactorPrecision::automatic) options.precision = FactorPrecision::double_precision;
  return options;
}

}  // namespace equidem
