// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The rates of contacts on their limits by every way there is to find them.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/breakage/unbonded/contact_rates.hpp"

namespace equidem {

struct RateSearch {
  RateAnswer answer;  ///< where none is found: of Newton's method, or of contacts that stick and do not hold the loads
  bool found = false;
  std::int64_t tried = 0;  ///< where none is found: combinations of statuses that were tried, which are all; 0: none
  std::int64_t ties = 0;   ///< of which round-off decides whether they are an answer
};

/// By Newton's method, then along a path from contacts that stick (rate_path.hpp), then by all combinations of statuses
/// where they are few. Where contacts on limits do not balance the loads although all of them stick, no other statuses
/// do: contacts that slip and open exert no other directions of force.
RateSearch search_rates(const RateProblem& problem, TangentSolver& solver, const std::vector<ContactStatus>& status);

}  // namespace equidem
