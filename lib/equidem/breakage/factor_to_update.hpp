// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The solver of networks that break, where it is left to the program.
#pragma once

#include "equidem/linear/linear_solver.hpp"

namespace equidem {

/// With elimination where the method is left to the library: its factor can be updated and tells the stability of each
/// network.
inline SolverOptions factor_to_update(SolverOptions options) {
  if (options.method == SolverMethod::automatic) options.method = SolverMethod::multifrontal;
  return options;
}

}  // namespace equidem
