// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A factorization that holds a mechanism which elimination took for a stiff motion.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "equidem/linear/factorization.hpp"

namespace equidem {

/// Solves with a positive semidefinite K that has a mechanism beside those which another factorization names.
/// \param rest of K with one component held, in which the mechanism cannot move
/// \param component held there, which moves in the mechanism
/// \param motion the mechanism, per component
std::unique_ptr<Factorization> hold_mechanism(std::unique_ptr<Factorization> rest, std::size_t component,
                                              std::vector<double> motion);

}  // namespace equidem
