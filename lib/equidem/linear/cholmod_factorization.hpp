// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Supernodal Cholesky factorization by CHOLMOD (Chen, Davis, Hager & Rajamanickam 2008).
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/factorization.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/multifrontal/front.hpp"

namespace equidem {

/// K = L L^T over the components that are not held. Returns a null pointer
/// where K is not positive definite to working precision. Held components are solved as rows of a unit matrix times the
/// largest spring. One factorization must not be used by two threads at once.
/// \param order discs in elimination order, for CholmodOrdering::equidem
/// \throws Error (computation_failed) where memory does not suffice or CHOLMOD fails
std::unique_ptr<Factorization> cholmod_cholesky(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns,
                                                CholmodOrdering ordering, std::span<const std::int32_t> order);

}  // namespace equidem
