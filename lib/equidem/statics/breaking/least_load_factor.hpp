// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The load factor at which a contact breaks, and how far changes of its forces can move it.
#pragma once

#include <algorithm>
#include <cmath>
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

/// The least lambda >= 0 at which a contact breaks.
struct BreakingPoint {
  double load_factor = std::numeric_limits<double>::infinity();
  bool in_shear = false;  ///< tension where both are reached at once
};

/// The least lambda >= 0 where start + lambda slope >= limit.
inline double least_factor(double start, double slope, double limit) {
  if (start >= limit) return 0;
  return slope > 0 ? (limit - start) / slope : std::numeric_limits<double>::infinity();
}

inline BreakingPoint breaking_point(const ProportionalForce& f, const ContactStrength& strength, double friction) {
  const double tension = least_factor(f.dead.normal, f.live.normal, strength.tension);
  const double pressed = friction * f.dead.normal, pressed_live = friction * f.live.normal;
  const double shear =
      std::min(least_factor(pressed + f.dead.tangential, pressed_live + f.live.tangential, strength.shear),
               least_factor(pressed - f.dead.tangential, pressed_live - f.live.tangential, strength.shear));
  return shear < tension ? BreakingPoint{shear, true} : BreakingPoint{tension, false};
}

/// The largest ratio of a force to its strength under the dead load; >= 0.
inline double dead_utilization(const ContactForce& dead, const ContactStrength& strength, double friction) {
  const double shear = std::abs(dead.tangential) + friction * dead.normal;
  return std::max({0.0, dead.normal / strength.tension, shear / strength.shear});
}

/// Where the forces of a contact change by (N, T) with N²/kN + T²/kT <= e², the ratio of a force to its strength
/// changes by at most e times this (Cauchy and Schwarz).
inline double utilization_rate(const SpringConstants& k, const ContactStrength& strength, double friction) {
  return std::max(std::sqrt(k.kN) / strength.tension,
                  std::sqrt(std::max(k.kT, 0.0) + friction * friction * k.kN) / strength.shear);
}

/// A set of contacts: the least load factor of any, and the largest utilization under the dead load.
struct Utilization {
  double load_factor = std::numeric_limits<double>::infinity();
  double dead = 0;

  void include(const Utilization& other) {
    load_factor = std::min(load_factor, other.load_factor);
    dead = std::max(dead, other.dead);
  }
  /// The worst that it can be where utilizations have changed by at most `by_dead` + lambda `by_live`: a utilization is
  /// convex in lambda, and so at most on the chord from lambda = 0 to the least load factor.
  [[nodiscard]] Utilization after(double by_dead, double by_live) const {
    const double slope = std::max(1 - dead, 0.0) / load_factor + by_live, left = 1 - dead - by_dead;
    const double least = left > 0 ? left / slope : 0;  // infinite without a slope, not a number without a strength
    return {least >= 0 ? std::min(least, load_factor) : 0, dead + by_dead};
  }
};

}  // namespace equidem
