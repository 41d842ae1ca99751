// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A factorization that follows changes of single contacts.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "equidem/linear/factorization.hpp"

namespace equidem {

/// K += c v v^T, with v over the components (u_x, u_y[, a theta]) of two discs: one spring of a contact, or, with
/// j = i, the support of a single disc.
struct RankOneChange {
  double stiffness = 0;  ///< c, Pa; negative: a spring is taken out
  std::int32_t i = 0, j = 0;
  std::array<double, 3> at_i{}, at_j{};  ///< v; at_j is added to at_i where j = i
};

class BreakableFactor : public Factorization {
 public:
  /// \return false where a pivot is lost in round-off: the factor is of no use any more, K has to be factorized anew
  [[nodiscard]] virtual bool change(std::span<const RankOneChange> changes) = 0;
};

}  // namespace equidem
