// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Plane waves of the continuum that an assembly stands for (Christoffel).
#pragma once

#include "equidem/core/matrix.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// c² in (m/s)²; negative where the continuum is unstable.
struct PlaneWaves {
  double longitudinal_squared = 0;  ///< of the wave whose motion is most along its direction
  double transverse_squared = 0;
};

/// Eigenvalues of A_ik = n_j n_l C_ijkl over the density: rho c² u = A u.
/// \param gradient_stiffness stress by displacement gradient, rows and columns (xx, yy, xy, yx), Pa
/// \param mass_per_area kg/m² (per metre of depth: of the assembly, not of its discs)
PlaneWaves plane_waves(const Matrix4& gradient_stiffness, double mass_per_area, Vec2 direction);

}  // namespace equidem
