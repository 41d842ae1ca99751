// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Multifrontal L D L^T factorization of an indefinite matrix on the dissection tree of the discs.
#pragma once

#include <memory>

#include "equidem/linear/factorization.hpp"
#include "equidem/linear/multifrontal/ldlt_factor.hpp"

namespace equidem {

/// P K P^T = L D L^T by LdltFactor, for kT < 0 with free edges too; the signs of D are the inertia of K.
std::unique_ptr<Factorization> multifrontal_ldlt(std::shared_ptr<const SymbolicFactor> symbolic,
                                                 const MatrixOnGraph& matrix, const IndefiniteOptions& options = {});

}  // namespace equidem
