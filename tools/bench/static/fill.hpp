// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Entries of the Cholesky factor that an order of elimination brings about.
#pragma once

#include <cstdint>
#include <span>

#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem::bench {

/// Entries of L in its lower triangle over the components that are not held, without the explicit zeros that
/// a factorization stores to work on dense blocks. Walks the row subtrees of the elimination tree (Liu 1990),
/// disc by disc: one step per block of L.
double count_factor_entries(const ContactGraph& graph, const DegreesOfFreedom& unknowns,
                            std::span<const std::int32_t> order);

}  // namespace equidem::bench
