// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/rate_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "equidem/core/statistics.hpp"
#include "equidem/core/stopwatch.hpp"

namespace equidem {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();
/// Over the stiffest spring: the softer, the more pieces a path may have, and the more of its answers need no other
/// status without ground.
constexpr std::array path_grounds{1e-3, 1e-6};
constexpr double level_slope = 1e-12;      // slopes below, over the springs, do not lead to an edge
constexpr std::size_t most_followed = 30;  // pieces from one solution of all responses to the next

/// Deformations of the contacts on limits, and the sum of the loads of the pattern times the motions.
struct Response {
  std::vector<ContactDeformation> deformation;
  double loads = 0;
};

/// The line a + b tau of a quantity that is not negative within a status, and the status behind its end.
struct Edge {
  double a, b;
  ContactStatus next;
};

class RatePath {
 public:
  RatePath(const RateProblem& problem, std::vector<ContactStatus> status, double ground)
      : problem_(problem), status_(std::move(status)), solver_(problem.contacts, ground * stiffest(problem)) {
    constexpr double golden = 0.618033988749895;
    // Different weights keep equal contacts, of symmetric packings, from changing at one tau.
    for (std::size_t p = 0; p < problem_.limits.size(); ++p)
      weight_.push_back(1 + 0.05 * std::fmod(golden * static_cast<double>(p + 1), 1.0));
    for (const LimitContact& at : problem_.limits) status_[at.contact] = ContactStatus::stuck;
  }

  /// \return whether the path has come to tau = 0
  bool follow() {
    set();
    respond();
    tau_ = first_tau();
    const double farthest = 1e6 * tau_;
    const std::size_t most = 100 + 4 * problem_.limits.size();  // paths of small networks take up to twice their number
    for (std::size_t piece = 0; piece < most; ++piece) {
      stop_if_interrupted();
      const Step step = next_step();
      if (way_ < 0 && step.way >= tau_) return true;
      tau_ += way_ * step.way;
      if (!(tau_ < farthest) || !change(step)) return false;
      if (piece % most_followed == most_followed - 1) respond();
    }
    return false;
  }
  [[nodiscard]] std::vector<ContactStatus> take_status() { return std::move(status_); }

 private:
  struct Step {
    double way = endless;   // of tau
    std::size_t place = 0;  // in RateProblem::limits
    ContactStatus next = ContactStatus::stuck;
  };

  static double stiffest(const RateProblem& problem) {
    double most = 0;
    for (const UnbondedLaw& law : problem.laws) most = std::max({most, law.k.kN, law.k.kT});
    return most;
  }
  [[nodiscard]] const UnbondedLaw& law(std::size_t p) const { return problem_.laws[problem_.limits[p].contact]; }
  [[nodiscard]] ContactStatus& status(std::size_t p) { return status_[problem_.limits[p].contact]; }
  [[nodiscard]] ContactStatus status(std::size_t p) const { return status_[problem_.limits[p].contact]; }

  /// The force beyond tangent times deformation, and beyond the pressing that loads balance, per unit of tau.
  [[nodiscard]] ContactForce beside(std::size_t p, ContactStatus status) const {
    if (status == ContactStatus::open) return {weight_[p], 0};
    if (is_slipping(status)) return {0, direction_of(status) * law(p).friction * weight_[p]};
    return {};
  }
  void set() {
    tangents_ = tangents_of(problem_.laws, status_);
    solver_.set(tangents_);
  }

  /// The response to lambda times the pattern, to the forces beside it where `others`, and to tau.
  [[nodiscard]] Response response_to(double lambda, bool others, double tau) const {
    const ContactOperator& contacts = problem_.contacts;
    Driving driving = problem_.driving;
    if (!others) driving.beside = {};
    const auto& held = contacts.unknowns().held;
    Rates rates = driven_rates(contacts, driving, lambda);
    std::vector<double> residual(contacts.components()), pressed(contacts.components(), 0.0);
    residual_of(contacts, tangents_, driving, rates, residual);
    for (std::size_t p = 0; p < problem_.limits.size() && tau != 0; ++p) {
      const ContactForce f = beside(p, status(p));
      contacts.add_internal(problem_.limits[p].contact, {tau * f.normal, tau * f.tangential}, pressed);
    }
    for (std::size_t k = 0; k < held.size(); ++k)
      if (held[k] == 0) residual[k] -= pressed[k];
    solver_.solve(residual);
    for (std::size_t k = 0; k < held.size(); ++k)
      if (held[k] == 0) rates.motion[k] = residual[k];
    const std::vector<double>& load = driving.pattern->force;
    Response response{{}, load.empty() ? 0 : dot(load, rates.motion)};
    for (const LimitContact& at : problem_.limits)
      response.deformation.push_back(deformation_of(contacts, driving, rates, at.contact));
    return response;
  }
  void respond() {
    const Driving& driving = problem_.driving;
    fixed_ = response_to(driving.by_motion ? 0 : driving.rate, true, 0);
    by_tau_ = response_to(0, false, 1);
    if (driving.by_motion) by_lambda_ = response_to(1, false, 0);
  }

  /// Deformations a + b tau of a contact, those of lambda included.
  [[nodiscard]] std::array<ContactDeformation, 2> line(std::size_t p) const {
    ContactDeformation a = fixed_.deformation[p], b = by_tau_.deformation[p];
    if (problem_.driving.by_motion) {
      const ContactDeformation& d = by_lambda_.deformation[p];
      const double lambda = (problem_.driving.rate - fixed_.loads) / by_lambda_.loads,
                   lambda_tau = -by_tau_.loads / by_lambda_.loads;
      a.normal += lambda * d.normal, a.tangential += lambda * d.tangential;
      b.normal += lambda_tau * d.normal, b.tangential += lambda_tau * d.tangential;
    }
    return {a, b};
  }

  /// Where all stick; a little more, so that no contact begins on an edge.
  [[nodiscard]] double first_tau() const {
    double tau = 0, force = 0;
    for (std::size_t p = 0; p < problem_.limits.size(); ++p) {
      const auto [a, b] = line(p);
      const double n = law(p).k.kN * a.normal, t = std::abs(law(p).k.kT * a.tangential);
      tau = std::max(tau, (n + (law(p).rough() ? t / law(p).friction : 0)) / weight_[p]);
      force = std::max({force, std::abs(n), t});
    }
    return 1.01 * tau + 0.01 * force;
  }

  /// The edges of the status of a contact; with n = kN dn - tau w and t = kT ds, those of its law.
  [[nodiscard]] std::vector<Edge> edges_of(std::size_t p) const {
    const auto [a, b] = line(p);
    const SpringConstants& k = law(p).k;
    const double mu = law(p).friction, n0 = k.kN * a.normal, n1 = k.kN * b.normal - weight_[p],
                 t0 = k.kT * a.tangential, t1 = k.kT * b.tangential;
    const LimitContact& at = problem_.limits[p];
    const bool apex = at.limit == OnLimit::apex;
    std::vector<Edge> edges;
    const auto slides = [&](double s) { edges.push_back({-mu * n0 - s * t0, -mu * n1 - s * t1, slipping(s)}); };
    switch (status(p)) {
      case ContactStatus::bonded:
        break;
      case ContactStatus::open:
        edges.push_back({n0, n1, law(p).rough() ? slipping(t0 + t1 * (n1 != 0 ? -n0 / n1 : 0)) : ContactStatus::stuck});
        break;
      case ContactStatus::stuck:
        if (!law(p).rough()) {
          edges.push_back({-n0, -n1, ContactStatus::open});
        } else if (apex) {
          slides(1), slides(-1);
        } else {
          slides(at.direction);
        }
        break;
      case ContactStatus::slips_forward:
      case ContactStatus::slips_backward: {
        const double s = direction_of(status(p));
        edges.push_back({s * t0 + mu * n0, s * t1 + mu * n1, ContactStatus::stuck});
        if (apex) edges.push_back({-n0, -n1, ContactStatus::open});
        break;
      }
    }
    return edges;
  }

  [[nodiscard]] Step next_step() const {
    Step first;
    for (std::size_t p = 0; p < problem_.limits.size(); ++p) {
      for (const Edge& edge : edges_of(p)) {
        // The edge over which the path has come; the slip of a contact that opens may have either sign there.
        const bool closes = status(p) == ContactStatus::open && is_slipping(before_);
        if (changed_ && p == last_ && (edge.next == before_ || closes)) continue;
        const double slope = way_ * edge.b;
        if (slope >= -level_slope * weight_[p]) continue;
        const double way = std::max(0.0, edge.a + edge.b * tau_) / -slope;
        if (way < first.way) first = {way, p, edge.next};
      }
    }
    return first;
  }

  /// Another status of one contact, by Woodbury's identity. \return false where the tangent becomes singular
  bool change(const Step& step) {
    if (step.way == endless) return false;
    const ContactOperator& contacts = problem_.contacts;
    const std::size_t contact = problem_.limits[step.place].contact;
    const ContactTangent now = tangents_[contact], then = law(step.place).tangent(step.next);
    const ContactForce from = beside(step.place, status(step.place)), to = beside(step.place, step.next);
    const auto beyond = [&](const ContactDeformation& d) {
      return ContactTangent{then.nn - now.nn, then.tn - now.tn, then.tt - now.tt}.rate(d);
    };
    // The responses to unit forces of the contact, and their 2 x 2 capacity matrix I + dA W.
    std::array<std::vector<double>, 2> z;
    std::array<ContactForce, 2> columns;
    std::array<double, 2> loads{};
    const auto& held = contacts.unknowns().held;
    for (std::size_t q = 0; q < 2; ++q) {
      z[q].assign(contacts.components(), 0.0);
      contacts.add_internal(contact, q == 0 ? ContactForce{1, 0} : ContactForce{0, 1}, z[q]);
      for (std::size_t k = 0; k < held.size(); ++k)
        if (held[k] != 0) z[q][k] = 0;
      solver_.solve(z[q]);
      columns[q] = beyond(contacts.deformation(contact, z[q]));
      if (problem_.driving.by_motion) loads[q] = dot(problem_.driving.pattern->force, z[q]);
    }
    columns[0].normal += 1, columns[1].tangential += 1;
    const double det = columns[0].normal * columns[1].tangential - columns[1].normal * columns[0].tangential;
    if (!(std::abs(det) > 0)) return false;
    const double loads_before = by_lambda_.loads;
    std::vector<std::array<ContactDeformation, 2>> w;
    for (const LimitContact& at : problem_.limits)
      w.push_back({contacts.deformation(at.contact, z[0]), contacts.deformation(at.contact, z[1])});
    const auto follow = [&](Response& response, const ContactForce& more) {
      const ContactForce f = beyond(response.deformation[step.place]);
      const double n = f.normal + more.normal, t = f.tangential + more.tangential;
      const double x = (columns[1].tangential * n - columns[1].normal * t) / det,
                   y = (columns[0].normal * t - columns[0].tangential * n) / det;
      for (std::size_t p = 0; p < w.size(); ++p) {
        response.deformation[p].normal -= w[p][0].normal * x + w[p][1].normal * y;
        response.deformation[p].tangential -= w[p][0].tangential * x + w[p][1].tangential * y;
      }
      response.loads -= loads[0] * x + loads[1] * y;
    };
    follow(fixed_, {});
    follow(by_tau_, {to.normal - from.normal, to.tangential - from.tangential});
    double sign = det;
    if (problem_.driving.by_motion) {
      follow(by_lambda_, {});
      sign *= by_lambda_.loads * loads_before;
    }
    if (sign < 0) way_ = -way_;
    changed_ = true;
    last_ = step.place;
    before_ = status(step.place);
    status(step.place) = step.next;
    set();
    return true;
  }

  const RateProblem& problem_;
  std::vector<ContactStatus> status_;  // per contact
  TangentSolver solver_;
  std::vector<ContactTangent> tangents_;
  std::vector<double> weight_;           // w, per contact on a limit
  Response fixed_, by_tau_, by_lambda_;  // the last one where a motion is prescribed
  double tau_ = 0, way_ = -1;
  bool changed_ = false;
  std::size_t last_ = 0;                         // place of the contact that changed last
  ContactStatus before_ = ContactStatus::stuck;  // its status before
};

/// \return the answer to which a path leads: one that balances the loads or, where none does, one of loads that drive
///         what nothing resists; none: no path leads to statuses that agree with their rates
std::optional<RateAnswer> follow_rates(const RateProblem& problem, TangentSolver& solver,
                                       const std::vector<ContactStatus>& status) {
  std::optional<RateAnswer> driven;
  for (const double ground : path_grounds) {
    RatePath path(problem, status, ground);
    if (!path.follow()) continue;
    RateAnswer answer = solve_rates(problem, solver, path.take_status());
    if (!answer.agrees) continue;
    if (answer.rates.balanced) return answer;
    driven = std::move(answer);
  }
  return driven;
}

/// Where loads drive what nothing resists, rates of that motion are forces over the ground, and round-off is a small
/// share of them: more than that is left of the other forces.
void decide_beside_large_rates(RateProblem problem, TangentSolver& solver, RateSearch& search) {
  problem.rounded = 1e-14;
  RateAnswer answer = solve_rates(problem, solver, search.answer.status);
  if (!answer.agrees) return;
  search.answer = std::move(answer);
  search.found = search.answer.rates.balanced;
}

/// Where loads drive what nothing resists, the statuses that do not depend on the present ones: others are decided by
/// the round-off of large rates, and stay as they were.
void keep_decided(const RateProblem& problem, const std::vector<ContactStatus>& before, RateAnswer& answer) {
  using enum ContactStatus;
  for (const LimitContact& at : problem.limits) {
    const auto after = [&](ContactStatus present) {
      return status_after(problem.laws[at.contact], at, answer.rates.deformation[at.contact], present,
                          answer.rates.negligible);
    };
    const ContactStatus status = after(stuck);
    const bool decided = std::ranges::all_of(std::array{open, slips_forward, slips_backward},
                                             [&](ContactStatus present) { return after(present) == status; });
    answer.status[at.contact] = decided ? status : before[at.contact];
  }
}

}  // namespace

RateSearch search_rates(const RateProblem& problem, TangentSolver& solver, const std::vector<ContactStatus>& status) {
  RateSearch search{solve_rates(problem, solver, status)};
  search.found = search.answer.agrees && search.answer.rates.balanced;
  if (search.found || problem.limits.empty()) return search;
  RateAnswer sticking{true, status, {}};
  for (const LimitContact& at : problem.limits) sticking.status[at.contact] = ContactStatus::stuck;
  sticking.rates = rates_of(problem.contacts, solver, tangents_of(problem.laws, sticking.status), problem.driving);
  if (!sticking.rates.balanced && !search.answer.agrees) {
    search.answer = std::move(sticking);
    search.answer.status = status;
    return search;
  }
  // Rates of what nothing resists are large, and their round-off may decide whether Newton's method goes round in
  // circles: then the path says what loads drive.
  std::optional<RateAnswer> other;
  if (sticking.rates.balanced) other = follow_rates(problem, solver, status);
  if (other && (other->rates.balanced || !search.answer.agrees)) search = {std::move(*other)};
  search.found = search.answer.agrees && search.answer.rates.balanced;
  if (!search.found && search.answer.agrees) decide_beside_large_rates(problem, solver, search);
  if (!search.found && search.answer.agrees) keep_decided(problem, status, search.answer);
  return search;
}

}  // namespace equidem
