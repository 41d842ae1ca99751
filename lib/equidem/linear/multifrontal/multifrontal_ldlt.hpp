// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Multifrontal L D L^T factorization of an indefinite matrix on the dissection tree of the discs.
#pragma once

#include <memory>

#include "equidem/linear/factorization.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

struct IndefiniteOptions {
  double threshold = 0.01;  ///< u: |L_ij| <= 1/u; larger is safer and delays more pivots
};

/// P K P^T = L D L^T with 1 x 1 and 2 x 2 pivots. Pivots that would grow
/// are delayed to the parent front, so that the factorization is as stable as a dense one with threshold pivoting.
/// The signs of D are the inertia of K. Unknowns that no front could eliminate count as zero_pivots: K is singular.
std::unique_ptr<Factorization> multifrontal_ldlt(std::shared_ptr<const SymbolicFactor> symbolic,
                                                 const MatrixOnGraph& matrix, const IndefiniteOptions& options = {});

}  // namespace equidem
