// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// --accuracy of `equidem run`: the time step.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/study/refinement.hpp"

#include "accuracy.hpp"
#include "command.hpp"

namespace equidem {

class BondedRun;

/// The longest step for which the displacements at the end are within the accuracy, relative to the largest one. Pilots
/// are runs with the step of the case, that over root 2, and its half (and finer ones, until the motions at the end
/// converge by the order of the integrator); they write nothing.
class StepSearch {
 public:
  /// \param given the run with the step of the case
  /// \throws Error (bad_input) where the run goes to rest
  StepSearch(const CommonOptions& options, double accuracy, const BondedRun& given);
  StepSearch(const StepSearch&) = delete;  // pilots refer to it
  StepSearch& operator=(const StepSearch&) = delete;

  /// The case with the step that should do.
  /// \throws Error (computation_failed) where no step does, or motions do not converge
  Case propose();
  /// Whether the motions at the end of its run are known to be within the accuracy.
  bool accepts(const std::vector<DiscMotion>& motions, double seconds);
  [[nodiscard]] ReachedAccuracy reached() const;

 private:
  [[nodiscard]] Case case_of(std::int64_t steps) const;
  [[nodiscard]] std::vector<double> motions_at_end(std::int64_t steps) const;
  [[nodiscard]] AccuracySetting setting_of(std::int64_t steps) const;

  CommonOptions options_;
  double accuracy_;
  double duration_;   ///< s
  double case_step_;  ///< s
  Refinement search_;
  std::vector<std::int64_t> runs_;  ///< steps of those that were proposed
  double seconds_ = 0;              ///< of the last one
};

}  // namespace equidem
