// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Elimination or multigrid: the method that "auto" takes.
#pragma once

#include <string>

#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/spring_network.hpp"

namespace equidem {

/// Costs of the two methods. The times are those of one machine (two threads of an AMD EPYC of 2024), so that
/// the choice is the same everywhere.
struct MethodForecast {
  double elimination = 0;        ///< s
  double multigrid = 0;          ///< s; infinity where the method does not serve
  double elimination_bytes = 0;  ///< at the peak
  double multigrid_bytes = 0;
};

/// From the number of discs, the shorter side of the sample, which bounds its fronts, the scatter of springs, which
/// adds iterations, and the number of right-hand sides.
MethodForecast forecast(const SpringNetwork& network, int right_hand_sides);

struct MethodChoice {
  SolverMethod method = SolverMethod::multifrontal;
  std::string reason;  ///< empty where there was nothing to weigh
};

/// The method that the options name; where they leave it to "auto", multigrid where it is forecast to be faster, or
/// where only its memory is available; never of few discs, where the difference is not felt and elimination finds more:
/// pivots and mechanisms.
MethodChoice choose_method(const SpringNetwork& network, const SolverOptions& options);

}  // namespace equidem
