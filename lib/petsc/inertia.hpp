// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The stability of an assembly that the ranks share, by the inertia of its stiffness matrix.
#pragma once

#include <cstdint>

#include <petscksp.h>

#include "petsc/network.hpp"

namespace equidem::petsc {

/// Numbers of negative pivots and of unstable modes, as in Equilibrium; -1: not counted.
struct Inertia {
  std::int64_t negative_pivots = -1;
  std::int64_t unstable_modes = -1;
};

/// Makes MUMPS count negative pivots: its dense root is then eliminated on one rank, since ScaLAPACK does not count.
/// Without effect on other solvers. To be called once options are set, before the factorization.
void prepare_to_count(KSP solver);

/// Where no spring is negative K is positive definite, and nothing needs to be counted. Else MUMPS has counted the
/// negative pivots of its L D L^T (Sylvester), and the rotations alone are factorized once more. Other solvers leave
/// the answer open: convergence of an iteration proves nothing.
Inertia inertia_of(const Network& network, KSP solver, Mat stiffness);

}  // namespace equidem::petsc
