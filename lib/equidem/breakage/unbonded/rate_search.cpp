// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/rate_search.hpp"

#include <optional>
#include <utility>

#include "equidem/breakage/unbonded/rate_branches.hpp"
#include "equidem/breakage/unbonded/rate_path.hpp"

namespace equidem {
namespace {

/// Where loads drive what nothing resists, rates of that motion are forces over the ground, and round-off is a small
/// share of them: more than that is left of the other forces.
void decide_beside_large_rates(RateProblem problem, TangentSolver& solver, RateSearch& search) {
  problem.rounded = 1e-14;
  RateAnswer answer = solve_rates(problem, solver, search.answer.status);
  if (!answer.agrees) return;
  search.answer = std::move(answer);
  search.found = search.answer.rates.balanced;
}

}  // namespace

RateSearch search_rates(const RateProblem& problem, TangentSolver& solver, const std::vector<ContactStatus>& status) {
  RateSearch search{solve_rates(problem, solver, status)};
  search.found = search.answer.agrees && search.answer.rates.balanced;
  if (search.found || problem.limits.empty()) return search;
  RateAnswer sticking{true, status, {}};
  for (const LimitContact& at : problem.limits) sticking.status[at.contact] = ContactStatus::stuck;
  sticking.rates = rates_of(problem.contacts, solver, tangents_of(problem.laws, sticking.status), problem.driving);
  if (!sticking.rates.balanced) {
    if (search.answer.agrees) {
      decide_beside_large_rates(problem, solver, search);
    } else {
      search.answer = std::move(sticking);
    }
    return search;
  }
  std::optional<RateAnswer> other = follow_rates(problem, solver, status);
  if (!other) {
    TriedStatuses all = try_all_statuses(problem, solver, status);
    search.tried = all.tried;
    search.ties = all.ties;
    other = std::move(all.answer);
  }
  search.found = other.has_value();
  if (other) {
    search.answer = std::move(*other);
  } else if (search.answer.agrees) {
    decide_beside_large_rates(problem, solver, search);
  }
  return search;
}

}  // namespace equidem
