// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/rate_branches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/breakage/unbonded/dense_lu.hpp"

namespace equidem {
namespace {

constexpr double same_rates = 1e-6;  // of the forces of answers that differ by round-off
constexpr double of_rates = 1e-10;   // round-off of forces, of springs times the rates of open contacts
constexpr double singular = 1e-10;   // least pivot of a combination that has rates at all

std::vector<ContactStatus> choices_of(const RateProblem& problem, const LimitContact& at) {
  using enum ContactStatus;
  if (at.limit == OnLimit::friction) return {stuck, slipping(at.direction)};
  if (!problem.laws[at.contact].rough()) return {stuck, open};
  return {stuck, open, slips_forward, slips_backward};
}

/// All combinations of the choices of several contacts, one after another.
class Combinations {
 public:
  Combinations(const RateProblem& problem, std::vector<LimitContact> limits) : limits_(std::move(limits)) {
    for (const LimitContact& at : limits_) choices_.push_back(choices_of(problem, at));
    digits_.assign(limits_.size(), 0);
  }
  [[nodiscard]] double count() const {
    double product = 1;
    for (const auto& choices : choices_) product *= static_cast<double>(choices.size());
    return product;
  }
  [[nodiscard]] const std::vector<LimitContact>& limits() const { return limits_; }
  [[nodiscard]] ContactStatus of(std::size_t k) const { return choices_[k][digits_[k]]; }
  /// \return false behind the last one
  bool next() {
    for (std::size_t k = 0; k < digits_.size(); ++k) {
      if (++digits_[k] < choices_[k].size()) return true;
      digits_[k] = 0;
    }
    return false;
  }

 private:
  std::vector<LimitContact> limits_;
  std::vector<std::vector<ContactStatus>> choices_;
  std::vector<std::size_t> digits_;
};

}  // namespace

Branches find_branches(const RateProblem& problem, std::span<const double> c, const RateAnswer& answer,
                       std::span<const std::size_t> fresh) {
  Branches result;
  Combinations all(problem, {problem.limits.begin(), problem.limits.end()});
  std::vector<std::size_t> place;  // in problem.limits, of the contacts that are tried
  for (std::size_t p = 0; p < problem.limits.size(); ++p) place.push_back(p);
  result.all_tried = all.count() <= static_cast<double>(most_branches);
  if (!result.all_tried) {
    std::erase_if(place,
                  [&](std::size_t p) { return std::ranges::find(fresh, problem.limits[p].contact) == fresh.end(); });
    std::vector<LimitContact> some;
    for (const std::size_t p : place) some.push_back(problem.limits[p]);
    all = Combinations(problem, std::move(some));
    if (all.count() > static_cast<double>(most_branches)) return result;
  }
  if (place.empty()) return result;
  const std::size_t n = 2 * problem.limits.size();
  std::vector<double> d0(n);
  for (std::size_t p = 0; p < problem.limits.size(); ++p) {
    const std::size_t contact = problem.limits[p].contact;
    d0[2 * p] = answer.rates.deformation[contact].normal;
    d0[2 * p + 1] = answer.rates.deformation[contact].tangential;
  }
  const double none = answer.rates.negligible;
  std::vector<double> system(n * n), d;
  std::vector<std::size_t> pivots;
  do {
    std::fill(system.begin(), system.end(), 0.0);
    for (std::size_t r = 0; r < n; ++r) system[r * n + r] = 1;
    bool differs = false;
    for (std::size_t k = 0; k < place.size(); ++k) {
      const std::size_t contact = problem.limits[place[k]].contact, q = 2 * place[k];
      const ContactTangent now = problem.laws[contact].tangent(answer.status[contact]);
      const ContactTangent then = problem.laws[contact].tangent(all.of(k));
      differs = differs || !(now == then);
      for (std::size_t r = 0; r < n; ++r) {
        system[r * n + q] += c[r * n + q] * (then.nn - now.nn) + c[r * n + q + 1] * (then.tn - now.tn);
        system[r * n + q + 1] += c[r * n + q + 1] * (then.tt - now.tt);
      }
    }
    if (!differs) continue;
    if (factorize_dense(system, pivots) < singular) {
      result.all_tried = false;
      continue;
    }
    d = d0;
    solve_dense(system, pivots, d);
    double change = 0, size = 0, round_off = 0;
    bool agrees = true;
    for (std::size_t p = 0, k = 0; p < problem.limits.size() && agrees; ++p) {
      const LimitContact& at = problem.limits[p];
      const bool tried = k < place.size() && place[k] == p;
      const ContactStatus status = tried ? all.of(k++) : answer.status[at.contact];
      const UnbondedLaw& law = problem.laws[at.contact];
      const ContactDeformation now{d0[2 * p], d0[2 * p + 1]}, then{d[2 * p], d[2 * p + 1]};
      agrees = status_after(law, at, then, status, none) == status;
      const ContactForce f0 = law.tangent(answer.status[at.contact]).rate(now), f = law.tangent(status).rate(then);
      change = std::max({change, std::abs(f.normal - f0.normal), std::abs(f.tangential - f0.tangential)});
      for (const ContactForce& force : {f0, f})
        size = std::max({size, std::abs(force.normal), std::abs(force.tangential)});
      for (const ContactDeformation& rate : {now, then})
        round_off = std::max({round_off, std::abs(law.k.kN * rate.normal), std::abs(law.k.kT * rate.tangential)});
    }
    if (!agrees || change <= std::max(same_rates * size, of_rates * round_off)) continue;
    if (++result.others > 1) continue;
    result.other = answer.status;
    for (std::size_t k = 0; k < place.size(); ++k) result.other[problem.limits[place[k]].contact] = all.of(k);
  } while (all.next());
  return result;
}

TriedStatuses try_all_statuses(const RateProblem& problem, TangentSolver& solver, std::vector<ContactStatus> status) {
  TriedStatuses result;
  Combinations all(problem, {problem.limits.begin(), problem.limits.end()});
  if (all.count() > static_cast<double>(most_branches)) return result;
  do {
    ++result.tried;
    for (std::size_t k = 0; k < problem.limits.size(); ++k) status[problem.limits[k].contact] = all.of(k);
    RateAnswer answer{true, status,
                      rates_of(problem.contacts, solver, tangents_of(problem.laws, status), problem.driving)};
    if (!answer.rates.balanced) continue;
    if (!agree_with_rates(problem, answer)) continue;
    result.answer = std::move(answer);
    return result;
  } while (all.next());
  return result;
}

}  // namespace equidem
