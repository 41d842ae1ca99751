// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// --accuracy of `equidem solve`: the size of the block of a tension test, or the bound of the solver.
#pragma once

#include <string>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"

#include "accuracy.hpp"
#include "command.hpp"
#include "problem.hpp"

namespace equidem {

/// A tension test of a lattice misses the lattice without sides by about one over its rows. Finds the rows and columns,
/// in the proportion of the case, for which nu, and the stiffness ratio (36) relative to itself, are within the
/// accuracy. Sides of whole fours and one disc: gauges then sit alike in all.
class BlockSearch final : public CaseSearch {
 public:
  static constexpr const char* plan =
      "blocks from 9 rows on are solved until their errors give the size that reaches it, at most 1e6 discs; below is "
      "the block of the case";
  /// Whether the case is such a test; where it is not there is nothing to choose.
  static bool serves(const Case& resolved);
  /// \param resolved read from `options`, one that it serves
  BlockSearch(const CommonOptions& options, const Case& resolved, double accuracy);

  static std::vector<double> values_of(const TensionResult& result);
  [[nodiscard]] ReachedAccuracy reached() const;

 private:
  std::string of_case_;  ///< the size in the case, in words
};

/// The error that the solver adds to the solution of a given assembly: its error bound.
/// \throws Error (computation_failed) where the bound is above the accuracy, or not known
ReachedAccuracy solver_accuracy(double accuracy, double error_bound, double condition, double seconds);

}  // namespace equidem
