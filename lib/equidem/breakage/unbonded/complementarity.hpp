// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Linear complementarity problems.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace equidem {

/// z with w = q + M z >= 0, z >= 0, w.z = 0, by Lemke's complementary pivots (Cottle, Pang & Stone, The Linear
/// Complementarity Problem, 1992, section 4.4).
/// \param m square, row-major
/// \return none where the pivots end on a ray
std::optional<std::vector<double>> solve_complementarity(std::span<const double> m, std::span<const double> q);

}  // namespace equidem
