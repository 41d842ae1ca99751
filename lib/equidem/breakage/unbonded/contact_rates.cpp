// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/contact_rates.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "equidem/breakage/event_path.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/stopwatch.hpp"

namespace equidem {
namespace {

constexpr double balanced = 1e-11, refined = 1e-14;
constexpr int most_refinements = 40;

/// \return the residual that is left
double refine(const ContactOperator& contacts, std::span<const ContactTangent> tangents, const TangentSolver& solver,
              const Driving& driving, Rates& rates) {
  const std::vector<double>& load = driving.pattern->force;
  std::vector<double> residual(rates.motion.size());
  std::optional<MotionControl> control;
  if (driving.by_motion) control.emplace(contacts, solver, load);
  double left = residual_of(contacts, tangents, driving, rates, residual);
  Rates best = rates;
  for (int k = 0; k < most_refinements; ++k) {
    if (k > 0 && left <= refined) break;
    solver.solve(residual);
    if (control) rates.lambda += control->hold(residual, driving.rate - dot(load, rates.motion));
    for (std::size_t m = 0; m < residual.size(); ++m) rates.motion[m] += residual[m];
    const double now = residual_of(contacts, tangents, driving, rates, residual);
    if (k > 1 && !(now < 0.8 * left)) {
      if (now < left) best = rates, left = now;
      break;
    }
    left = now;
    best = rates;
  }
  rates = std::move(best);
  if (!control || driving.rate == 0) return left;
  // Where nothing resists the motion no load drives it: lambda is what refinement has left of the load that the springs
  // of the ground would take, with a residual that does its work.
  residual_of(contacts, tangents, driving, rates, residual);
  double lost = 0;
  for (std::size_t k = 0; k < residual.size(); ++k) lost += std::abs(residual[k] * rates.motion[k]);
  const double power = std::abs(rates.lambda * driving.rate),
               by_ground = squared(driving.rate) / std::abs(control->work());
  if (power <= 10 * lost || power <= 1e-6 * by_ground) {
    rates.lambda = 0;
    left = residual_of(contacts, tangents, driving, rates, residual);
  }
  return left;
}

/// Sets Rates::negligible.
void set_negligible(const RateProblem& problem, Rates& rates) {
  double largest = 0;
  for (std::size_t c = 0; c < problem.laws.size(); ++c) {
    const ContactDeformation& d = rates.deformation[c];
    const SpringConstants& k = problem.laws[c].k;
    largest = std::max({largest, std::abs(k.kN * d.normal), std::abs(k.kT * d.tangential)});
  }
  // A part that moves rigidly shows the rounding of its motion as deformations: no contact breaks or opens by them.
  rates.negligible = std::max(1e-9 * rates.force_scale + problem.rounded * largest, rates.round_off);
}

struct StatusChange {
  std::size_t contact;
  ContactStatus wanted;
  bool forceless;  ///< a slip to the other side of a contact that carries no force: it changes no rate
};

/// The contacts on limits whose rates ask for another status.
std::vector<StatusChange> inconsistent(const RateProblem& problem, const RateAnswer& answer) {
  std::vector<StatusChange> wrong;
  const double none = answer.rates.negligible;
  for (const LimitContact& at : problem.limits) {
    const ContactStatus present = answer.status[at.contact];
    const UnbondedLaw& law = problem.laws[at.contact];
    const ContactDeformation& rate = answer.rates.deformation[at.contact];
    const ContactStatus wanted = status_after(law, at, rate, present, none);
    if (wanted == present) continue;
    const bool forceless = is_slipping(wanted) && is_slipping(present) && law.k.kN * rate.normal >= -none;
    wrong.push_back({at.contact, wanted, forceless});
  }
  return wrong;
}

/// Sets the statuses of the contacts on limits to those that follow from the rates, RateAnswer::agrees and
/// Rates::negligible.
/// \return whether they were those already, but for slips to the other side without a force
bool agree_with_rates(const RateProblem& problem, RateAnswer& answer) {
  set_negligible(problem, answer.rates);
  const auto wrong = inconsistent(problem, answer);
  answer.agrees = std::ranges::all_of(wrong, &StatusChange::forceless);
  for (const StatusChange& change : wrong) answer.status[change.contact] = change.wanted;
  return answer.agrees;
}

}  // namespace

MotionControl::MotionControl(const ContactOperator& contacts, const TangentSolver& solver, std::span<const double> load)
    : load_(load), along_(load.begin(), load.end()) {
  const auto& held = contacts.unknowns().held;
  for (std::size_t k = 0; k < along_.size(); ++k) along_[k] = held[k] != 0 ? 0 : along_[k];
  solver.solve(along_);
  work_ = dot(load_, along_);
}

double MotionControl::hold(std::span<double> motion, double wanted) const {
  const double lambda = (wanted - dot(load_, motion)) / work_;
  for (std::size_t k = 0; k < motion.size(); ++k) motion[k] += lambda * along_[k];
  return lambda;
}

ContactDeformation deformation_of(const ContactOperator& contacts, const Driving& driving, const Rates& rates,
                                  std::size_t contact) {
  ContactDeformation d = contacts.deformation(contact, rates.motion);
  if (driving.affine.empty()) return d;
  d.normal += rates.lambda * driving.affine[contact].normal;
  d.tangential += rates.lambda * driving.affine[contact].tangential;
  return d;
}

double residual_of(const ContactOperator& contacts, std::span<const ContactTangent> tangents, const Driving& driving,
                   Rates& rates, std::vector<double>& residual) {
  const auto& held = contacts.unknowns().held;
  const std::vector<double>& load = driving.pattern->force;
  std::vector<double> internal(contacts.components(), 0.0);
  rates.force_scale = 0;
  double stiffest = 0, fastest = 0;
  for (const double u : rates.motion) fastest = std::max(fastest, std::abs(u));
  rates.deformation.resize(contacts.contacts());
  for (std::size_t c = 0; c < contacts.contacts(); ++c) {
    const ContactDeformation d = deformation_of(contacts, driving, rates, c);
    if (!driving.affine.empty()) fastest = std::max({fastest, std::abs(d.normal), std::abs(d.tangential)});
    rates.deformation[c] = d;
    stiffest = std::max(stiffest, tangents[c].nn);
    const ContactForce f = tangents[c].rate(d);
    if (f.normal == 0 && f.tangential == 0) continue;
    rates.force_scale = std::max({rates.force_scale, std::abs(f.normal), std::abs(f.tangential)});
    contacts.add_internal(c, f, internal);
  }
  double sum = 0;
  for (std::size_t k = 0; k < held.size(); ++k) {
    residual[k] = 0;
    if (held[k] != 0) continue;
    const double from_load = load.empty() ? 0 : rates.lambda * load[k];
    const double beside = driving.beside.empty() ? 0 : driving.beside[k];
    rates.force_scale = std::max({rates.force_scale, std::abs(from_load), std::abs(beside)});
    residual[k] = from_load + beside - internal[k];
    sum = std::max(sum, std::abs(residual[k]));
  }
  // Forces that no more than the rounding of motions leaves are none.
  const double none = rounded_motion * stiffest * fastest;
  rates.force_scale = std::max(rates.force_scale, none);
  rates.round_off = none;
  if (sum <= none) return 0;
  return rates.force_scale > 0 ? sum / rates.force_scale : 0;
}

Rates driven_rates(const ContactOperator& contacts, const Driving& driving, double lambda) {
  Rates rates{.motion = std::vector<double>(contacts.components(), 0.0), .lambda = lambda};
  const auto& held = contacts.unknowns().held;
  const std::vector<double>& prescribed = driving.pattern->prescribed;
  for (std::size_t k = 0; k < held.size(); ++k) {
    if (held[k] != 0 && !prescribed.empty()) rates.motion[k] = lambda * prescribed[k];
  }
  return rates;
}

Rates rates_of(const ContactOperator& contacts, TangentSolver& solver, std::span<const ContactTangent> tangents,
               const Driving& driving) {
  solver.set(tangents);
  for (int attempt = 0;; ++attempt) {
    Rates rates = driven_rates(contacts, driving, driving.by_motion ? 0 : driving.rate);
    const double left = refine(contacts, tangents, solver, driving, rates);
    rates.balanced = left <= balanced;
    if (rates.balanced || attempt > 0) return rates;
    solver.refresh();
  }
}

std::vector<ContactTangent> tangents_of(std::span<const UnbondedLaw> laws, std::span<const ContactStatus> status) {
  std::vector<ContactTangent> tangents;
  tangents.reserve(laws.size());
  for (std::size_t c = 0; c < laws.size(); ++c) tangents.push_back(laws[c].tangent(status[c]));
  return tangents;
}

RateAnswer solve_rates(const RateProblem& problem, TangentSolver& solver, std::vector<ContactStatus> status) {
  RateAnswer answer;
  answer.status = std::move(status);
  std::set<std::vector<ContactStatus>> seen;
  const auto on_limits = [&] {
    std::vector<ContactStatus> chosen;
    for (const LimitContact& at : problem.limits) chosen.push_back(answer.status[at.contact]);
    return chosen;
  };
  constexpr int most = 60;
  for (int k = 0; k < most && seen.insert(on_limits()).second; ++k) {
    stop_if_interrupted();
    answer.rates = rates_of(problem.contacts, solver, tangents_of(problem.laws, answer.status), problem.driving);
    if (agree_with_rates(problem, answer)) return answer;
  }
  return answer;
}

}  // namespace equidem
