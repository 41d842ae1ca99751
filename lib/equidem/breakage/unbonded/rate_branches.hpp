// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Other answers of the rate problem of contacts on their limits: with friction it need not have just one.
///
/// Relative to an answer with the tangents A, another choice of statuses with the tangents A + dA has the deformations
///
///   (I + C dA) D = D_0,   C = G K^-1 G^T over the contacts on limits,
///
/// so that all combinations can be tried in the space of those contacts, without the network.
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
  bool all_tried = false;              ///< every combination; false: they are too many, or one has no unique rates
  std::int64_t others = 0;             ///< answers with other rates of force than the one given
  std::vector<ContactStatus> other{};  ///< per contact, of the first of them; empty: none
};

/// \param compliance of the contacts on limits (limit_compliance.hpp), with the tangents of the answer
/// \param fresh the contacts whose statuses are tried where those of all are too many
Branches find_branches(const RateProblem& problem, std::span<const double> compliance, const RateAnswer& answer,
                       std::span<const std::size_t> fresh);

/// The first of all combinations of statuses that agrees with its rates and balances the loads.
struct TriedStatuses {
  std::int64_t tried = 0;  ///< 0: they are more than most_branches
  std::optional<RateAnswer> answer{};
};
TriedStatuses try_all_statuses(const RateProblem& problem, TangentSolver& solver, std::vector<ContactStatus> status);

}  // namespace equidem
