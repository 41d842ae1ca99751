// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// L y = b over the fronts of a Cholesky factor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "equidem/linear/kernels/panel_solve.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"

namespace equidem {

/// Small subtrees run on separate threads, then the fronts above them, level by level. A subtree keeps what it passes
/// to the discs above it apart, and its own discs take what they get in place. The division does not depend on the
/// number of threads, and so the bits of the result do not.
class ForwardSweep {
 public:
  explicit ForwardSweep(const SymbolicFactor& symbolic);

  /// \param y columns in the order of elimination, `size` numbers from one to the next: b on input
  /// \param columns <= most_columns
  void run(const std::function<Panel(std::size_t front)>& panel, double* y, std::size_t size,
           std::size_t columns) const;

 private:
  struct Sweep;
  const SymbolicFactor& symbolic_;
  std::vector<std::int32_t> subtrees_;             // their roots
  std::vector<std::vector<std::int32_t>> levels_;  // fronts above them, those that wait for no other one first
  std::vector<std::int32_t> handed_;  // per front, in discs: where what it passes on begins; -1: it is inside a subtree
  std::int32_t all_handed_ = 0;       // discs
};

}  // namespace equidem
