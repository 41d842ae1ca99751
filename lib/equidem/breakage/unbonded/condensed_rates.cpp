// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/condensed_rates.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/breakage/unbonded/dense_lu.hpp"
#include "equidem/breakage/unbonded/half_spaces.hpp"

namespace equidem {
namespace {

constexpr double least_noise = 1e-14;                 // of S beside 1
constexpr double zero_pivot = 1e2, sure_pivot = 1e4;  // times the noise of S
constexpr double of_forces = 1e-9, of_slips = 1e-11;  // round-off, as Rates::negligible
constexpr double violated = 100;                      // times round-off: what violates equations
constexpr double same_rates = 1e-6,
                 of_springs = 1e-10;         // of forces, and of springs times rates, that differ by round-off
constexpr double response_residual = 1e-12;  // residual of a response, over its force
constexpr int most_response_refinements = 5;

double largest_component(std::span<const double> x) {
  double most = 0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return most;
}

double inner_product_of(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace

/// One combination: M x = b for the components that are not zero, and what must not be negative.
struct CondensedRates::Equations {
  std::vector<std::size_t> components{};
  std::vector<Line> vanish{}, hold{};
  std::vector<std::size_t> place_of_hold{};  // in RateProblem::limits
};

CondensedRates::CondensedRates(const RateProblem& problem, TangentSolver& solver, std::span<const std::size_t> tried,
                               std::vector<ContactStatus> status)
    : problem_(problem), tried_(tried.begin(), tried.end()), status_(std::move(status)) {
  for (const std::size_t p : tried_) {
    const LimitContact& at = problem_.limits[p];
    status_[at.contact] = ContactStatus::stuck;
    if (at.limit == OnLimit::apex) components_.push_back({p, false, std::sqrt(law(p).k.kN)});
    if (law(p).rough()) components_.push_back({p, true, std::sqrt(law(p).k.kT)});
  }
  const std::vector<ContactTangent> tangents = tangents_of(problem_.laws, status_);
  sticking_ = rates_of(problem_.contacts, solver, tangents, problem_.driving);
  known_ = sticking_.balanced;
  if (!known_) return;
  respond(solver);
  for (const Felt& felt : felt_)
    size_ = std::max({size_, std::abs(felt.normal.constant), std::abs(felt.tangential.constant)});
  double stiffest = 0;
  for (const UnbondedLaw& each : problem_.laws) stiffest = std::max(stiffest, each.k.kN);
  if (stiffest > 0) size_ = std::max(size_, sticking_.force_scale / std::sqrt(stiffest));
}

/// The motions by each component of e, without the springs of the ground, and what the contacts on limits feel of them.
void CondensedRates::respond(TangentSolver& solver) {
  const ContactOperator& contacts = problem_.contacts;
  const auto& held = contacts.unknowns().held;
  const std::vector<double>& load = problem_.driving.pattern->force;
  const std::vector<ContactTangent> tangents = tangents_of(problem_.laws, status_);
  const auto response = [&](const std::vector<double>& force) {
    std::vector<double> x(force.size(), 0.0), residual = force, best;
    double left = largest_component(force), least = left;
    for (int k = 0; k < most_response_refinements && left > 0; ++k) {
      solver.solve(residual);
      for (std::size_t m = 0; m < x.size(); ++m) x[m] += residual[m];
      std::vector<double> internal(x.size(), 0.0);
      for (std::size_t c = 0; c < contacts.contacts(); ++c) {
        const ContactForce f = tangents[c].rate(contacts.deformation(c, x));
        if (f.normal != 0 || f.tangential != 0) contacts.add_internal(c, f, internal);
      }
      for (std::size_t m = 0; m < x.size(); ++m) residual[m] = held[m] != 0 ? 0 : force[m] - internal[m];
      left = largest_component(residual);
      if (k > 0 && !(left < least)) break;
      least = left;
      best = x;
    }
    known_ = known_ && least <= response_residual * std::max(largest_component(force), 1e-300);
    return best.empty() ? x : best;
  };
  const auto force_of = [&](std::size_t contact, const ContactForce& pair) {
    std::vector<double> force(contacts.components(), 0.0);
    contacts.add_internal(contact, pair, force);
    for (std::size_t k = 0; k < force.size(); ++k)
      if (held[k] != 0) force[k] = 0;
    return force;
  };
  std::vector<double> along;
  if (problem_.driving.by_motion) {
    along = load;
    for (std::size_t k = 0; k < along.size(); ++k)
      if (held[k] != 0) along[k] = 0;
    along = response(along);
  }
  for (const Component& component : components_) {
    const std::size_t contact = problem_.limits[component.place].contact;
    const ContactForce pair = component.tangential ? ContactForce{0, component.root} : ContactForce{component.root, 0};
    std::vector<double> z = response(force_of(contact, pair));
    double by = 0;
    if (problem_.driving.by_motion) {
      by = -inner_product_of(load, z) / inner_product_of(load, along);
      for (std::size_t k = 0; k < z.size(); ++k) z[k] += by * along[k];
    }
    lambda_.push_back(by);
    motion_.push_back(std::move(z));
  }
  for (std::size_t p = 0; p < problem_.limits.size(); ++p) {
    const std::size_t contact = problem_.limits[p].contact, none = components_.size();
    const double root_n = std::sqrt(law(p).k.kN), root_t = law(p).rough() ? std::sqrt(law(p).k.kT) : 0;
    const ContactDeformation& d = sticking_.deformation[contact];
    Felt felt{{root_n * d.normal, {}}, {root_t * d.tangential, {}}, none, none};
    for (std::size_t q = 0; q < components_.size(); ++q) {
      const ContactDeformation by = contacts.deformation(contact, motion_[q]);
      const bool own = components_[q].place == p;
      const bool tangential = components_[q].tangential;
      if (own) (tangential ? felt.slips : felt.opens) = q;
      felt.normal.by.push_back(root_n * by.normal - (own && !tangential ? 1 : 0));
      felt.tangential.by.push_back(root_t * by.tangential - (own && tangential ? 1 : 0));
    }
    felt_.push_back(std::move(felt));
  }
  // S is symmetric where no other contact slips: what it lacks is round-off.
  noise_ = least_noise;
  if (tried_.size() < problem_.limits.size()) return;
  const auto entry = [&](std::size_t r, std::size_t q) {
    const Felt& felt = felt_[components_[r].place];
    return components_[r].tangential ? felt.tangential.by[q] : felt.normal.by[q];
  };
  for (std::size_t r = 0; r < components_.size(); ++r)
    for (std::size_t q = 0; q < r; ++q) noise_ = std::max(noise_, std::abs(entry(r, q) - entry(q, r)));
}

double CondensedRates::ratio(std::size_t place) const {
  return law(place).friction * std::sqrt(law(place).k.kN / law(place).k.kT);
}

/// s T + mu N over sqrt(kT) + mu sqrt(kN): not positive where the contact sticks, zero where it slips to the side s.
CondensedRates::Line CondensedRates::limit_line(std::size_t place, double side) const {
  const double mu = ratio(place), t = side / (1 + mu), n = mu / (1 + mu);
  const Felt& felt = felt_[place];
  Line line{t * felt.tangential.constant + n * felt.normal.constant, felt.normal.by};
  for (std::size_t q = 0; q < line.by.size(); ++q) line.by[q] = n * line.by[q] + t * felt.tangential.by[q];
  return line;
}

void CondensedRates::add_conditions(std::size_t place, ContactStatus status, Equations& equations) const {
  const auto hold = [&](Line line, double sign) {
    line.constant *= sign;
    for (double& x : line.by) x *= sign;
    equations.hold.push_back(std::move(line));
    equations.place_of_hold.push_back(place);
  };
  const auto component = [&](std::size_t q) {
    Line line{0, std::vector<double>(components_.size(), 0.0)};
    line.by[q] = 1;
    return line;
  };
  const LimitContact& limit = problem_.limits[place];
  const Felt& felt = felt_[place];
  const bool apex = limit.limit == OnLimit::apex, rough = law(place).rough();
  const std::size_t none = components_.size();
  if (status == ContactStatus::open) {
    equations.components.push_back(felt.opens);
    equations.vanish.push_back(felt.normal);
    hold(component(felt.opens), 1);
    if (!rough) return;
    equations.components.push_back(felt.slips);
    equations.vanish.push_back(felt.tangential);
    return;
  }
  if (apex) hold(felt.normal, -1);
  if (is_slipping(status)) {
    const double side = direction_of(status);
    if (felt.slips == none) return hold(limit_line(place, side), 1);  // it is not tried
    equations.components.push_back(felt.slips);
    equations.vanish.push_back(limit_line(place, side));
    return hold(component(felt.slips), side);
  }
  if (!rough) return;
  for (const double side : {1.0, -1.0})
    if (apex || side == limit.direction) hold(limit_line(place, side), -1);
}

/// The round-off of forces, in their units.
double CondensedRates::round_off(std::span<const double> e) const {
  return of_forces * size_ + of_slips * largest_component(e);
}

Combination CondensedRates::at(std::vector<double> e, std::span<const ContactStatus> status) const {
  Combination result;
  const auto value = [&](const Line& line) { return line.constant + inner_product_of(line.by, e); };
  for (std::size_t p = 0, k = 0; p < problem_.limits.size(); ++p) {
    const bool tried = k < tried_.size() && tried_[k] == p;
    const ContactStatus now = tried ? status[k++] : status_[problem_.limits[p].contact];
    const Felt& felt = felt_[p];
    const double root_n = std::sqrt(law(p).k.kN), root_t = law(p).rough() ? std::sqrt(law(p).k.kT) : 0;
    const double n = root_n * value(felt.normal), t = root_t * value(felt.tangential);
    result.force.push_back(now == ContactStatus::open ? ContactForce{}
                           : is_slipping(now)         ? ContactForce{n, -direction_of(now) * law(p).friction * n}
                                                      : ContactForce{n, t});
    const double opened = felt.opens < e.size() ? e[felt.opens] / root_n : 0,
                 slipped = felt.slips < e.size() ? e[felt.slips] / root_t : 0;
    result.rate.push_back({n / law(p).k.kN + opened, root_t > 0 ? t / law(p).k.kT + slipped : 0});
  }
  result.e = std::move(e);
  return result;
}

bool CondensedRates::equal(std::span<const ContactForce> a, std::span<const ContactForce> b,
                           std::span<const ContactDeformation> rate) const {
  double change = 0, size = 0, round_off = 0;
  for (std::size_t p = 0; p < a.size(); ++p) {
    change = std::max({change, std::abs(a[p].normal - b[p].normal), std::abs(a[p].tangential - b[p].tangential)});
    for (const ContactForce& f : {a[p], b[p]}) size = std::max({size, std::abs(f.normal), std::abs(f.tangential)});
    const SpringConstants& k = law(p).k;
    round_off = std::max({round_off, std::abs(k.kN * rate[p].normal), std::abs(k.kT * rate[p].tangential)});
  }
  return change <= std::max(same_rates * size, of_springs * round_off);
}

Combination CondensedRates::decide(std::span<const ContactStatus> of_tried, std::span<const ContactForce> same) const {
  Equations equations;
  for (std::size_t p = 0, k = 0; p < problem_.limits.size(); ++p) {
    const bool tried = k < tried_.size() && tried_[k] == p;
    add_conditions(p, tried ? of_tried[k++] : status_[problem_.limits[p].contact], equations);
  }
  const std::size_t n = equations.components.size(), all = components_.size();
  FullPivots solution(n);
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t q = 0; q < n; ++q) solution.matrix(r, q) = equations.vanish[r].by[equations.components[q]];
    solution.right(r) = -equations.vanish[r].constant;
  }
  const double gap = solution.eliminate(zero_pivot * noise_);
  const std::vector<double> x = solution.least();
  std::vector<double> e(all, 0.0);
  for (std::size_t q = 0; q < n; ++q) e[equations.components[q]] = x[q];
  Combination found = at(e, of_tried);
  const double none = round_off(e);
  if (solution.left() > violated * none) return found;
  if (gap < sure_pivot * noise_ || solution.left() > none) {
    found.verdict = Verdict::undecided;
    return found;
  }
  // Motions that the equations leave free.
  const std::vector<std::vector<double>> free = solution.free();
  const std::size_t d = free.size();
  const auto along = [&](const Line& line, std::size_t k) {
    double sum = 0;
    for (std::size_t q = 0; q < n; ++q) sum += line.by[equations.components[q]] * free[k][q];
    return sum;
  };
  bool forces_free = false;
  for (std::size_t k = 0; k < d; ++k) {
    for (const Felt& felt : felt_) {
      forces_free = forces_free || std::abs(along(felt.normal, k)) > sure_pivot * noise_ ||
                    std::abs(along(felt.tangential, k)) > sure_pivot * noise_;
    }
  }
  if (!forces_free && !same.empty() && equal(found.force, same, found.rate)) return found;
  std::vector<double> g, h;
  for (const Line& line : equations.hold) {
    g.push_back(line.constant + inner_product_of(line.by, e));
    for (std::size_t k = 0; k < d; ++k) h.push_back(along(line, k));
  }
  // A contact that rests, or slips without a normal force whatever the others do, satisfies its status as long as they
  // do.
  const auto rests = [&](std::size_t place, std::span<const double> at_e) {
    const Felt& felt = felt_[place];
    const auto part = [&](std::size_t q) { return q < all ? std::abs(at_e[q]) : 0; };
    double most = part(felt.opens);
    for (const Line* line : {&felt.normal, &felt.tangential})
      most = std::max(most, std::abs(line->constant + inner_product_of(line->by, at_e)));
    if (most > none) return false;
    double by_others = 0;
    for (std::size_t q = 0; q < all; ++q)
      if (q != felt.opens) by_others = std::max(by_others, std::abs(felt.normal.by[q]));
    return part(felt.slips) <= none || by_others < sure_pivot * noise_;
  };
  const auto moves = [&](std::size_t row) {
    return largest_component(std::span(h).subspan(row * d, d)) > sure_pivot * noise_;
  };
  std::vector<double> g_some, h_some;
  std::vector<std::size_t> rows;
  for (std::size_t r = 0; r < g.size(); ++r) {
    if (!moves(r) && std::abs(g[r]) <= none) continue;
    rows.push_back(r);
    g_some.push_back(g[r]);
    h_some.insert(h_some.end(), h.begin() + static_cast<std::ptrdiff_t>(r * d),
                  h.begin() + static_cast<std::ptrdiff_t>((r + 1) * d));
  }
  const WidestPoint widest =
      widest_point(g_some, h_some, d, std::max(size_, largest_component(e)), sure_pivot * noise_);
  if (widest.margin < -none) return found;
  for (std::size_t k = 0; k < d; ++k)
    for (std::size_t q = 0; q < n; ++q) e[equations.components[q]] += widest.place[k] * free[k][q];
  found = at(e, of_tried);
  bool sure_of_all = !forces_free;
  for (std::size_t r = 0; r < g.size(); ++r) {
    const double value = g[r] + inner_product_of(std::span(h).subspan(r * d, d), widest.place);
    sure_of_all = sure_of_all && (value > none || rests(equations.place_of_hold[r], e));
  }
  found.verdict = sure_of_all ? Verdict::answer : Verdict::tie;
  return found;
}

Rates CondensedRates::rates(const Combination& combination) const {
  Rates rates = sticking_;
  for (std::size_t q = 0; q < combination.e.size(); ++q) {
    rates.lambda += lambda_[q] * combination.e[q];
    for (std::size_t k = 0; k < rates.motion.size(); ++k) rates.motion[k] += motion_[q][k] * combination.e[q];
  }
  return rates;
}

}  // namespace equidem
