// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The load factor at which a contact breaks, the first contact of many, and how far changes of its forces can move it.
///
/// With forces N0 + lambda N1, T0 + lambda T1 the criteria of a contact are linear in lambda:
///
///   tension   N - f_t >= 0
///   shear     +-T + mu N - f_s >= 0
///
/// Seen from a value lambda_0 in the direction of a leg, a criterion a + b t >= 0 with lambda = lambda_0 +- t, t >= 0,
/// is met first at
///
///   t = 0      where a > 0, or a = 0 and b >= 0: it is met at lambda_0 itself (b of whatever sign: on from there, or
///              only there)
///   t = -a/b   where a < 0 and b > 0, or never where b <= 0
///
/// A path without control has lambda_0 = 0 in every network: each network is loaded anew from its dead loads, and a
/// contact that they alone break does so at lambda = 0. Under control lambda_0 is where the control holds the network;
/// of several contacts that are beyond their strength there, that goes first which reached it at the least load.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "equidem/contact/frame.hpp"
#include "equidem/material/spring_constants.hpp"

namespace equidem {

/// A contact breaks in tension where N >= tension, in shear where |T| >= shear - friction N. Infinite: never.
struct ContactStrength {
  double tension = std::numeric_limits<double>::infinity();  ///< N/m
  double shear = std::numeric_limits<double>::infinity();    ///< N/m
};

/// Forces are dead + lambda live.
struct ProportionalForce {
  ContactForce dead, live;  ///< N/m
};

/// The value and the direction of lambda from which the next break is sought.
struct LoadFactorSearch {
  double from = 0;             ///< lambda_0
  double direction = 1;        ///< of lambda, 1 or -1
  bool by_least_load = false;  ///< order of contacts that are beyond their strength at `from`; false: their numbers
  /// N/m of live and dead forces, below which a component is round-off and counts as 0. A contact that carries no force
  /// does not break, whatever its strength. Negative: no component is cut.
  double no_live = -1, no_dead = -1;
};

/// When a contact breaks: t, infinite where it never does, and among those with t = 0 the order.
struct BreakingMoment {
  double t = std::numeric_limits<double>::infinity(), order = t;
  bool in_shear = false;  ///< tension where both are reached at once

  [[nodiscard]] double key() const { return t > 0 ? t : order; }
};

namespace least_load_factor {

/// \param a, b of the criterion a + b t >= 0
inline void meet(double a, double b, bool in_shear, bool by_least_load, BreakingMoment& first) {
  constexpr double never = std::numeric_limits<double>::infinity();
  BreakingMoment found{.in_shear = in_shear};
  if (a > 0 || (a == 0 && b >= 0)) {
    found.t = 0;
    found.order = !by_least_load ? 0 : b > 0 ? -a / b : -never;
  } else if (b > 0) {
    found.t = -a / b;
  }
  if (found.t < first.t || (found.t == first.t && found.order < first.order)) first = found;
}

inline ContactForce cut(const ContactForce& f, double none) {
  return {std::abs(f.normal) <= none ? 0 : f.normal, std::abs(f.tangential) <= none ? 0 : f.tangential};
}

}  // namespace least_load_factor

inline BreakingMoment breaking_moment(const ProportionalForce& force, const ContactStrength& strength, double friction,
                                      const LoadFactorSearch& search) {
  using least_load_factor::cut, least_load_factor::meet;
  const ContactForce f1 = cut(force.live, search.no_live), f0 = cut(force.dead, search.no_dead);
  BreakingMoment first;
  if (f0.normal == 0 && f0.tangential == 0 && f1.normal == 0 && f1.tangential == 0) return first;
  const double n = f0.normal + search.from * f1.normal, s = f0.tangential + search.from * f1.tangential;
  const double dn = search.direction * f1.normal, ds = search.direction * f1.tangential;
  meet(n - strength.tension, dn, false, search.by_least_load, first);
  for (const double sign : {1.0, -1.0})
    meet(sign * s + friction * n - strength.shear, sign * ds + friction * dn, true, search.by_least_load, first);
  return first;
}

/// The distance from a key within which others are its ties: round-off of equal load factors.
inline double tie_distance(double key, const LoadFactorSearch& search) {
  constexpr double same = 1e-10;  // relative
  const double reached = search.from + search.direction * key;
  return std::isfinite(reached) ? same * std::max(std::abs(reached), std::abs(search.from)) : 0;
}

/// The contact of least key, of ties that of least number.
struct FirstToBreak {
  std::int64_t contact = -1;  ///< -1: none breaks
  BreakingMoment moment{};
  std::int64_t ties = 0;                                 ///< other contacts that break at the same lambda
  double gap = std::numeric_limits<double>::infinity();  ///< of lambda, relative, to the next that does not tie

  /// \param moment_of index -> BreakingMoment, contact_of index -> its number, for indices below `count`
  template <typename MomentOf, typename ContactOf>
  static FirstToBreak among(std::size_t count, const MomentOf& moment_of, const ContactOf& contact_of,
                            const LoadFactorSearch& search) {
    constexpr double never = std::numeric_limits<double>::infinity();
    FirstToBreak found;
    double least = never, second = never;
    for (std::size_t k = 0; k < count; ++k) least = std::min(least, moment_of(k).key());
    if (least == never) return found;
    const double tied = least + tie_distance(least, search);
    for (std::size_t k = 0; k < count; ++k) {
      const BreakingMoment moment = moment_of(k);
      if (moment.key() > tied) {
        second = std::min(second, moment.key());
        continue;
      }
      if (found.contact >= 0) ++found.ties;
      const std::int64_t number = contact_of(k);
      if (found.contact < 0 || number < found.contact) found.contact = number, found.moment = moment;
    }
    const double reached = search.from + search.direction * least;
    if (reached != 0 && std::isfinite(reached)) found.gap = (second - least) / std::abs(reached);
    return found;
  }
};

/// The largest ratio of a force to its strength under the dead load; >= 0. Infinite where there is no strength.
inline double dead_utilization(const ContactForce& dead, const ContactStrength& strength, double friction) {
  if (!(strength.tension > 0 && strength.shear > 0)) return std::numeric_limits<double>::infinity();
  const double shear = std::abs(dead.tangential) + friction * dead.normal;
  return std::max({0.0, dead.normal / strength.tension, shear / strength.shear});
}

/// Where the forces of a contact change by (N, T) with N²/kN + T²/kT <= e², the ratio of a force to its strength
/// changes by at most e times this (Cauchy and Schwarz).
inline double utilization_rate(const SpringConstants& k, const ContactStrength& strength, double friction) {
  if (strength.tension == 0 || strength.shear == 0) return std::numeric_limits<double>::infinity();
  return std::max(std::sqrt(k.kN) / strength.tension,
                  std::sqrt(std::max(k.kT, 0.0) + friction * friction * k.kN) / strength.shear);
}

/// A set of contacts, seen from lambda = 0: the least |lambda| at which any breaks in the direction of a search, and
/// the largest utilization under the dead load, negative where there are no contacts.
struct Utilization {
  double load_factor = std::numeric_limits<double>::infinity();
  double dead = -1;

  void include(const Utilization& other) {
    load_factor = std::min(load_factor, other.load_factor);
    dead = std::max(dead, other.dead);
  }
  /// The worst that it can be where utilizations have changed by at most `by_dead` + lambda `by_live`: a utilization is
  /// convex in lambda, and so at most on the chord from lambda = 0 to the least load factor.
  [[nodiscard]] Utilization after(double by_dead, double by_live) const {
    if (dead < 0) return *this;
    const double slope = std::max(1 - dead, 0.0) / load_factor + by_live, left = 1 - dead - by_dead;
    const double least = left > 0 ? left / slope : 0;  // infinite without a slope, not a number without a strength
    return {least >= 0 ? std::min(least, load_factor) : 0, dead + by_dead};
  }
  /// No key of these contacts in a search is less.
  [[nodiscard]] double least_key(const LoadFactorSearch& search) const {
    if (dead < 0) return std::numeric_limits<double>::infinity();
    const double gone = search.direction * search.from;
    constexpr double less = 1 - 1e-14;  // for round-off: keys are found from search.from, load factors from 0
    return gone >= 0 && load_factor > gone ? less * load_factor - gone : -std::numeric_limits<double>::infinity();
  }
};

/// Contacts are classed by their utilization_rate, in steps of 2 down from the largest one of a network: a bound by the
/// rate of a few weak contacts would hide that the many others are far from breaking.
constexpr std::size_t rate_classes = 8;

/// The class of a rate > 0; the last one has all that are lower still.
inline std::size_t rate_class(double rate, double largest) {
  if (!(rate < largest)) return 0;
  return std::min(static_cast<std::size_t>(std::ilogb(largest / rate)), rate_classes - 1);
}

/// A set of contacts, by their classes.
struct ClassedUtilization {
  std::array<Utilization, rate_classes> of{};

  /// A contact that breaks at once may be among them.
  [[nodiscard]] static ClassedUtilization unknown() {
    ClassedUtilization all;
    all.of.fill({0, 0});
    return all;
  }
  void include(const ClassedUtilization& other) {
    for (std::size_t c = 0; c < rate_classes; ++c) of[c].include(other.of[c]);
  }
  [[nodiscard]] double least_key(const LoadFactorSearch& search) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Utilization& one : of) least = std::min(least, one.least_key(search));
    return least;
  }
};

}  // namespace equidem
