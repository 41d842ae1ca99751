// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// --accuracy of `equidem solve`: the size of the block of a tension test, or the bound of the solver.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/study/refinement.hpp"

#include "accuracy.hpp"
#include "command.hpp"
#include "problem.hpp"

namespace equidem {

/// A tension test of a lattice misses the lattice without sides by about one over its rows. Finds the rows and columns,
/// in the proportion of the case, for which nu, and the stiffness ratio (36) relative to itself, are within the
/// accuracy. Sides of whole fours and one disc: gauges then sit alike in all.
class BlockSearch {
 public:
  /// Whether the case is such a test; where it is not there is nothing to choose.
  static bool serves(const Case& resolved);
  /// \param resolved read from `options`, one that it serves
  BlockSearch(const CommonOptions& options, const Case& resolved, double accuracy);
  BlockSearch(const BlockSearch&) = delete;  // pilots refer to it
  BlockSearch& operator=(const BlockSearch&) = delete;

  /// The case of the block that should do.
  /// \throws Error (computation_failed) where that takes more than a million discs, or errors do not fall as one over
  ///         the rows
  Case propose();
  /// Whether the block is known to be within the accuracy.
  bool accepts(const TensionResult& result, double seconds);
  [[nodiscard]] ReachedAccuracy reached() const;

 private:
  struct Size {
    std::int64_t rows = 0, columns = 0;
  };
  [[nodiscard]] Size size_of(std::int64_t rows) const;
  [[nodiscard]] Case case_of(std::int64_t rows) const;
  [[nodiscard]] static AccuracySetting setting_of(const Size& size);
  std::vector<double> solve_pilot(std::int64_t rows);

  CommonOptions options_;
  double accuracy_;
  double aspect_;
  std::string of_case_;  ///< the size in the case, in words
  Refinement search_;
  std::vector<std::int64_t> proposed_;
  double seconds_ = 0;        ///< of the last one proposed
  double other_seconds_ = 0;  ///< of all before
};

/// The error that the solver adds to the solution of a given assembly: its error bound.
/// \throws Error (computation_failed) where the bound is above the accuracy, or not known
ReachedAccuracy solver_accuracy(double accuracy, double error_bound, double condition, double seconds);

}  // namespace equidem
