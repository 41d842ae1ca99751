// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/break_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr double no_break = std::numeric_limits<double>::infinity();

/// When a contact breaks: t, infinite where it never does, and among those with t = 0 the order.
struct BreakingMoment {
  double t = no_break, order = no_break;
  bool in_shear = false;  ///< tension where both are reached at once

  [[nodiscard]] double key() const { return t > 0 ? t : order; }
};

/// \param a, b of the criterion a + b t >= 0
void meet(double a, double b, bool in_shear, bool by_least_load, BreakingMoment& first) {
  BreakingMoment found{.in_shear = in_shear};
  if (a > 0 || (a == 0 && b >= 0)) {
    found.t = 0;
    found.order = !by_least_load ? 0 : b > 0 ? -a / b : -no_break;
  } else if (b > 0) {
    found.t = -a / b;
  }
  if (found.t < first.t || (found.t == first.t && found.order < first.order)) first = found;
}

ContactForce cut(const ContactForce& f, double none) {
  return {std::abs(f.normal) <= none ? 0 : f.normal, std::abs(f.tangential) <= none ? 0 : f.tangential};
}

BreakingMoment breaking_moment(const ContactForce& live, const ContactForce& dead, double tension, double shear,
                               double friction, const LoadFactorSearch& search) {
  const ContactForce f1 = cut(live, search.no_live), f0 = cut(dead, search.no_dead);
  BreakingMoment first;
  if (f0.normal == 0 && f0.tangential == 0 && f1.normal == 0 && f1.tangential == 0) return first;
  const double n = f0.normal + search.from * f1.normal, s = f0.tangential + search.from * f1.tangential;
  const double dn = search.direction * f1.normal, ds = search.direction * f1.tangential;
  meet(n - tension, dn, false, search.by_least_load, first);
  for (const double sign : {1.0, -1.0})
    meet(sign * s + friction * n - shear, sign * ds + friction * dn, true, search.by_least_load, first);
  return first;
}

}  // namespace

TiedKeys tied_keys(std::span<const double> keys, double tied) {
  TiedKeys found{.first = keys.size()};
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (keys[k] > tied) {
      found.beyond = std::min(found.beyond, keys[k]);
    } else {
      ++found.others;
      found.first = std::min(found.first, k);
    }
  }
  return found;
}

std::optional<NextBreak> next_break(std::span<const ContactForce> pattern, std::span<const ContactForce> dead,
                                    const ContactStrengths& strengths, const LoadFactorSearch& search) {
  const auto moment_of = [&](std::size_t c) {
    return breaking_moment(pattern[c], dead.empty() ? ContactForce{} : dead[c], strengths.tension[c],
                           strengths.shear[c], strengths.friction, search);
  };
  std::vector<double> keys(pattern.size());
  parallel_ranges(keys.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) keys[c] = moment_of(c).key();
  });
  double least = no_break;
  for (const double key : keys) least = std::min(least, key);
  if (least == no_break) return {};
  constexpr double same = 1e-10;  // share of lambda: round-off of equal load factors
  const double reached = search.from + search.direction * least;
  const double tied = least + (std::isfinite(reached) ? same * std::max(std::abs(reached), std::abs(search.from)) : 0);
  const TiedKeys ties = tied_keys(keys, tied);
  const double gap = reached != 0 && std::isfinite(reached) ? (ties.beyond - least) / std::abs(reached) : no_break;
  const BreakingMoment moment = moment_of(ties.first);
  return NextBreak{search.from + search.direction * moment.t, ties.first,
                   moment.in_shear ? BreakMode::shear : BreakMode::tension, ties.others, gap};
}

}  // namespace equidem
