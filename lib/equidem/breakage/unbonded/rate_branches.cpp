// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/rate_branches.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "equidem/breakage/unbonded/condensed_rates.hpp"

namespace equidem {
namespace {

std::vector<ContactStatus> choices_of(const RateProblem& problem, const LimitContact& at) {
  using enum ContactStatus;
  if (at.limit == OnLimit::friction) return {stuck, slipping(at.direction)};
  if (!problem.laws[at.contact].rough()) return {stuck, open};
  return {stuck, open, slips_forward, slips_backward};
}

/// All combinations of the choices of several contacts, one after another.
class Combinations {
 public:
  /// \param places in RateProblem::limits
  Combinations(const RateProblem& problem, std::span<const std::size_t> places) : digits_(places.size(), 0) {
    for (const std::size_t p : places) choices_.push_back(choices_of(problem, problem.limits[p]));
  }
  [[nodiscard]] double count() const {
    double product = 1;
    for (const auto& choices : choices_) product *= static_cast<double>(choices.size());
    return product;
  }
  /// Statuses of the contacts, in their order.
  [[nodiscard]] std::vector<ContactStatus> status() const {
    std::vector<ContactStatus> status;
    for (std::size_t k = 0; k < digits_.size(); ++k) status.push_back(choices_[k][digits_[k]]);
    return status;
  }
  /// \return false behind the last one
  bool next() {
    for (std::size_t k = 0; k < digits_.size(); ++k) {
      if (++digits_[k] < choices_[k].size()) return true;
      digits_[k] = 0;
    }
    return false;
  }

 private:
  std::vector<std::size_t> digits_;
  std::vector<std::vector<ContactStatus>> choices_;
};

std::vector<std::size_t> places_of_all(const RateProblem& problem) {
  std::vector<std::size_t> places(problem.limits.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  return places;
}

RateAnswer answer_of(const RateProblem& problem, TangentSolver& solver, const CondensedRates& condensed,
                     const Combination& combination, std::span<const std::size_t> places,
                     std::span<const ContactStatus> of_places, std::vector<ContactStatus> status) {
  for (std::size_t k = 0; k < places.size(); ++k) status[problem.limits[places[k]].contact] = of_places[k];
  const Rates begin = condensed.rates(combination);
  RateAnswer answer{true, std::move(status), {}};
  answer.rates = rates_of(problem.contacts, solver, tangents_of(problem.laws, answer.status), problem.driving, &begin);
  set_negligible(problem, answer.rates);
  return answer;
}

}  // namespace

Branches find_branches(const RateProblem& problem, TangentSolver& solver, const RateAnswer& answer,
                       std::span<const std::size_t> fresh) {
  Branches result;
  std::vector<std::size_t> places = places_of_all(problem);
  Combinations all(problem, places);
  result.all_tried = all.count() <= static_cast<double>(most_branches);
  if (!result.all_tried) {
    std::erase_if(places,
                  [&](std::size_t p) { return std::ranges::find(fresh, problem.limits[p].contact) == fresh.end(); });
    all = Combinations(problem, places);
    if (all.count() > static_cast<double>(most_branches)) return result;
  }
  if (places.empty()) return result;
  const std::vector<ContactTangent> base = solver.base(), tangents = tangents_of(problem.laws, answer.status);
  const CondensedRates condensed(problem, solver, places, answer.status);
  if (!condensed.known()) {
    ++result.ties;
    solver.restore(base, tangents);
    return result;
  }
  std::vector<std::vector<ContactForce>> known(1), ties;
  for (const LimitContact& at : problem.limits) {
    const ContactTangent tangent = problem.laws[at.contact].tangent(answer.status[at.contact]);
    known.front().push_back(tangent.rate(answer.rates.deformation[at.contact]));
  }
  do {
    const std::vector<ContactStatus> status = all.status();
    const Combination tried = condensed.decide(status, known.front());
    if (tried.verdict == Verdict::none) continue;
    const auto same = [&](const auto& force) { return condensed.equal(tried.force, force, tried.rate); };
    if (std::ranges::any_of(known, same)) continue;
    if (tried.verdict != Verdict::answer) {
      ties.push_back(tried.force);
      continue;
    }
    std::erase_if(ties, same);
    if (++result.others == 1)
      result.other = answer_of(problem, solver, condensed, tried, places, status, answer.status);
    known.push_back(tried.force);
  } while (all.next());
  result.ties = std::ssize(ties);
  solver.restore(base, tangents);
  return result;
}

TriedStatuses try_all_statuses(const RateProblem& problem, TangentSolver& solver,
                               const std::vector<ContactStatus>& status) {
  TriedStatuses result;
  const std::vector<std::size_t> places = places_of_all(problem);
  Combinations all(problem, places);
  if (all.count() > static_cast<double>(most_branches)) return result;
  const CondensedRates condensed(problem, solver, places, status);
  if (!condensed.known()) return result;
  const auto take = [&](const Combination& tried, std::span<const ContactStatus> of_places) {
    RateAnswer answer = answer_of(problem, solver, condensed, tried, places, of_places, status);
    if (answer.rates.balanced) result.answer = std::move(answer);
  };
  std::optional<std::pair<Combination, std::vector<ContactStatus>>> within_round_off;
  do {
    ++result.tried;
    const std::vector<ContactStatus> of_places = all.status();
    Combination tried = condensed.decide(of_places, {});
    if (tried.verdict == Verdict::answer) take(tried, of_places);
    if (result.answer) return result;
    if (tried.verdict == Verdict::none) continue;
    ++result.ties;
    if (tried.verdict == Verdict::tie && !within_round_off) within_round_off.emplace(std::move(tried), of_places);
  } while (all.next());
  if (within_round_off) take(within_round_off->first, within_round_off->second);
  return result;
}

}  // namespace equidem
