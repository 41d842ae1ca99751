// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The ratio kT/kN at which an assembly with its supports gives way.
#pragma once

#include <span>

#include "equidem/assembly/assembly.hpp"
#include "equidem/statics/supports.hpp"

namespace equidem {

struct CriticalRatioOptions {
  double lowest = -1;       ///< where the search ends, in [-1, 0)
  double tolerance = 1e-6;  ///< width of the interval that is left, > 0
};

/// The ratio r_c < 0 of equal springs below which the assembly is unstable in statics: the stiffness with rotations
/// eliminated is linear in kT, S = K_N + kT S_T with S_T >= 0, so that S loses definiteness once and for good as r
/// falls. Found by bisection on the number of negative eigenvalues of K beyond those of the rotations. Negative
/// infinity where the assembly is stable down to `lowest`; 0 where it is not stable for any kT < 0.
/// \throws Error (bad_input) as EquilibriumSolver does, for kT > 0
double critical_ratio(const Assembly& assembly, std::span<const Support> supports,
                      const CriticalRatioOptions& options = {});

}  // namespace equidem
