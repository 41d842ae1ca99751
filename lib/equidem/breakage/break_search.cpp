// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/break_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double same = 1e-10;  // of lambda: round-off of two equal ones

/// When a contact breaks: t, and among those with t = 0 the order.
struct Moment {
  double t = infinite, order = infinite;
  BreakMode mode = BreakMode::tension;

  [[nodiscard]] double key() const { return t > 0 ? t : order; }
};

/// \param a, b of the criterion a + b t >= 0
void meet(double a, double b, BreakMode mode, bool by_least_load, Moment& first) {
  Moment found{.mode = mode};
  if (a > 0 || (a == 0 && b >= 0)) {
    found.t = 0;
    found.order = !by_least_load ? 0 : b > 0 ? -a / b : -infinite;
  } else if (b > 0) {
    found.t = -a / b;
  }
  if (found.t < first.t || (found.t == first.t && found.order < first.order)) first = found;
}

Moment moment_of(const BreakSearch& search, std::size_t contact) {
  const auto cut = [](ContactForce f, double none) {
    return ContactForce{std::abs(f.normal) <= none ? 0 : f.normal, std::abs(f.tangential) <= none ? 0 : f.tangential};
  };
  const ContactForce f1 = cut(search.pattern[contact], search.no_pattern);
  const ContactForce f0 = search.dead.empty() ? ContactForce{} : cut(search.dead[contact], search.no_dead);
  Moment first;
  if (f0.normal == 0 && f0.tangential == 0 && f1.normal == 0 && f1.tangential == 0) return first;
  const double n = f0.normal + search.from * f1.normal, s = f0.tangential + search.from * f1.tangential;
  const double dn = search.direction * f1.normal, ds = search.direction * f1.tangential;
  const auto& [tension, shear, mu] = search.strengths;
  meet(n - tension[contact], dn, BreakMode::tension, search.by_least_load, first);
  for (const double sign : {1.0, -1.0}) {
    meet(sign * s + mu * n - shear[contact], sign * ds + mu * dn, BreakMode::shear, search.by_least_load, first);
  }
  return first;
}

}  // namespace

std::optional<NextBreak> next_break(const BreakSearch& search) {
  const std::size_t count = search.pattern.size();
  // Keys order what is beyond its strength at `from` (negative or 0) before what breaks later.
  std::vector<Moment> moments(count);
  parallel_ranges(count, 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) moments[c] = moment_of(search, c);
  });
  double least = infinite, second = infinite;  // the second: the least that does not tie
  for (const Moment& moment : moments) least = std::min(least, moment.key());
  if (least == infinite) return {};
  const double reached = search.from + search.direction * least;
  const double tolerance = std::isfinite(reached) ? same * std::max(std::abs(reached), std::abs(search.from)) : 0;
  std::optional<NextBreak> next;
  for (std::size_t c = 0; c < count; ++c) {
    const double key = moments[c].key();
    if (key > least + tolerance) {
      second = std::min(second, key);
    } else if (next) {
      ++next->ties;
    } else {
      next = NextBreak{search.from + search.direction * moments[c].t, c, moments[c].mode, 0, 0};
    }
  }
  next->gap = reached != 0 ? (second - least) / std::abs(reached) : infinite;
  return next;
}

}  // namespace equidem
