// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// --accuracy of `equidem run`: the time step.
#pragma once

#include <vector>

#include "equidem/contact/frame.hpp"

#include "accuracy.hpp"
#include "command.hpp"

namespace equidem {

class BondedRun;

/// The longest step for which the displacements at the end are within the accuracy, relative to the largest one. Pilots
/// are runs with the step of the case, that over root 2, and its half (and finer ones, until the motions at the end
/// converge by the order of the integrator); they write nothing.
class StepSearch final : public CaseSearch {
 public:
  static constexpr const char* plan =
      "first runs with the step of the case, that over root 2 and its half; the longest step that reaches it follows "
      "from them; above is the run with the step of the case";
  /// \param given the run with the step of the case
  /// \throws Error (bad_input) where the run goes to rest
  StepSearch(const CommonOptions& options, double accuracy, const BondedRun& given);

  static std::vector<double> values_of(const std::vector<DiscMotion>& motions);
  [[nodiscard]] ReachedAccuracy reached() const;

 private:
  double case_step_;  ///< s
};

}  // namespace equidem
