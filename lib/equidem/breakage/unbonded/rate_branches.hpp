// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Other answers of the rate problem of contacts on their limits: with friction it need not have just one.
///
/// All combinations of the statuses of a few contacts are decided in the space of these contacts (condensed_rates.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "equidem/breakage/unbonded/contact_rates.hpp"

namespace equidem {

/// Combinations of statuses that are tried, at most.
inline constexpr std::int64_t most_branches = 4096;

/// Contacts on limits for which dense matrices of their size are made, at most: 5 MB each.
inline constexpr std::size_t most_on_limits = 400;

struct Branches {
  bool all_tried = false;   ///< every combination of all contacts on limits; false: they are too many
  std::int64_t ties = 0;    ///< combinations of which round-off decides whether they are another answer
  std::int64_t others = 0;  ///< answers with other rates of force than the one given and than each other
  RateAnswer other{};       ///< the first of them
  [[nodiscard]] bool decided() const { return all_tried && (ties == 0 || others > 0); }
};

/// \param solver with the tangents of the answer, before and after
/// \param fresh the contacts whose statuses are tried where those of all are too many
Branches find_branches(const RateProblem& problem, TangentSolver& solver, const RateAnswer& answer,
                       std::span<const std::size_t> fresh);

/// The first of all combinations of statuses that agrees with its rates and balances the loads.
struct TriedStatuses {
  std::int64_t tried = 0;  ///< 0: they are more than most_branches, or S is not known
  std::int64_t ties = 0;   ///< where none is an answer: combinations of which round-off decides whether they are one
  std::optional<RateAnswer> answer{};
};
TriedStatuses try_all_statuses(const RateProblem& problem, TangentSolver& solver,
                               const std::vector<ContactStatus>& status);

}  // namespace equidem
