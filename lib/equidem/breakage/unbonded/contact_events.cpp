// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/contact_events.hpp"

#include <algorithm>
#include <cmath>

namespace equidem {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr double same_time = 1e-10;  // of the parameter: events at once

}  // namespace

std::vector<LimitContact> contacts_on_limits(const UnbondedState& state, std::span<const UnbondedLaw> laws) {
  const double none = state.negligible_force();
  std::vector<LimitContact> limits;
  for (std::size_t c = 0; c < laws.size(); ++c) {
    const ContactStatus status = state.status()[c];
    if (status == ContactStatus::bonded) continue;
    const double n = state.normal_coordinate(c);
    if (status == ContactStatus::open ? n > none : n < -none && !laws[c].rough()) continue;
    // The force that a broken bond has yet to give up is no part of the law.
    const ContactForce f = state.law_force(c);
    if (n >= -none || status == ContactStatus::open) {
      limits.push_back({c, OnLimit::apex, 1});
    } else if (is_slipping(status)) {
      limits.push_back({c, OnLimit::friction, direction_of(status)});
    } else if (std::abs(f.tangential) + laws[c].friction * n >= -none) {
      limits.push_back({c, OnLimit::friction, f.tangential < 0 ? -1.0 : 1.0});
    }
  }
  return limits;
}

NextContactEvent next_contact_event(const UnbondedState& state, std::span<const UnbondedLaw> laws,
                                    const ContactStrengths& strengths, const Rates& rates, double stage) {
  const double none = rates.negligible, tolerance = state.negligible_force();
  std::vector<double> times(laws.size(), never);
  std::vector<std::optional<BreakMode>> modes(laws.size());
  const auto reach = [&](std::size_t c, double a, double b, std::optional<BreakMode> mode) {
    double t = never;
    if (a > tolerance && mode) {
      t = 0;
    } else if (b > none && (mode || a + b * stage > tolerance)) {
      t = std::max(0.0, -a / b);
    }
    if (t < times[c]) times[c] = t, modes[c] = mode;
  };
  const double mu = strengths.friction;
  for (std::size_t c = 0; c < laws.size(); ++c) {
    const ContactStatus status = state.status()[c];
    const ContactDeformation& d = rates.deformation[c];
    const ContactForce f = state.law_force(c);
    const auto [n1, t1] = laws[c].tangent(status).rate(d);
    switch (status) {
      case ContactStatus::bonded:
        reach(c, f.normal - strengths.tension[c], n1, BreakMode::tension);
        for (const double sign : {1.0, -1.0})
          reach(c, sign * f.tangential + mu * f.normal - strengths.shear[c], sign * t1 + mu * n1, BreakMode::shear);
        break;
      case ContactStatus::stuck:
        if (!laws[c].rough()) {
          reach(c, f.normal, n1, {});
          break;
        }
        for (const double sign : {1.0, -1.0})
          reach(c, sign * f.tangential + laws[c].friction * f.normal, sign * t1 + laws[c].friction * n1, {});
        break;
      case ContactStatus::slips_forward:
      case ContactStatus::slips_backward:
        reach(c, f.normal, n1, {});
        break;
      case ContactStatus::open:
        reach(c, -state.normal_coordinate(c), -laws[c].k.kN * d.normal, {});
        break;
    }
  }
  NextContactEvent next;
  for (const double t : times) next.t = std::min(next.t, t);
  if (next.t == never) return next;
  const TiedKeys ties = tied_keys(times, next.t * (1 + same_time));
  next.contact = ties.first;
  next.breaks = modes[ties.first];
  next.ties = ties.others;
  next.gap = next.t > 0 ? ties.beyond / next.t - 1 : ties.beyond;
  return next;
}

}  // namespace equidem
