// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fabric: the distribution of contact directions.
#pragma once

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// Directional measures of a contact network. Anisotropies are amplitudes of the harmonics of psi(theta) over its mean
/// (contact_harmonics): 0 where no direction is preferred, 2 where all contacts have it; at 0 the direction means
/// nothing.
struct Fabric {
  Tensor2 normal;           ///< <n n>, trace 1 (Satake 1982)
  Tensor2 branch;           ///< (1/A) sum l l^T, dimensionless: its trace is S of the Voigt stiffness
  double anisotropy_2 = 0;  ///< sqrt(a_2² + b_2²): how much one axis is preferred
  double direction_2 = 0;   ///< rad, of that axis, in [0, pi)
  double anisotropy_4 = 0;  ///< sqrt(a_4² + b_4²): how much two axes at right angles are
  double direction_4 = 0;   ///< rad, of the first of them, in [0, pi/2)
  double mean_branch = 0;   ///< m
};

/// \throws Error (bad_input) where there are no contacts, or a free assembly has no cell areas
Fabric fabric(const Assembly& assembly);

}  // namespace equidem
