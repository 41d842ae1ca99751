// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Multifrontal Cholesky factorization on the dissection tree of the discs.
#pragma once

#include <memory>

#include "equidem/linear/factorization.hpp"
#include "equidem/linear/multifrontal/front.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"

namespace equidem {

/// K = L L^T (Duff & Reid 1983), subtrees on separate threads, large fronts in tiles; the same bits for every number
/// of threads. Returns a null pointer where K is not positive definite to working precision; `report`, where given,
/// contains the place.
std::unique_ptr<Factorization> multifrontal_cholesky(std::shared_ptr<const SymbolicFactor> symbolic,
                                                     const MatrixOnGraph& matrix, FactorReport* report = nullptr);

}  // namespace equidem
