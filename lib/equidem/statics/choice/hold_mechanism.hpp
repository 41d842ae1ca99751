// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A factorization that holds a mechanism which elimination took for a stiff motion.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "equidem/linear/factorization.hpp"

namespace equidem {

/// Of a positive semidefinite K, with a mechanism beside those that another factorization names.
/// \param rest of K with one component held, in which the mechanism cannot move
/// \param component held there, which moves in the mechanism
/// \param motion the mechanism, per component
std::unique_ptr<Factorization> hold_mechanism(std::unique_ptr<Factorization> rest, std::size_t component,
                                              std::vector<double> motion);

}  // namespace equidem
