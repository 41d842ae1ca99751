// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The map P of Fujioka & Ushijima (2005 b), section 2: the first step of a contact is corrected to the true instant at
/// which it began and loses energy according to the restitution; later steps conserve (sigma² + a d²)/2.
///
/// With the slope s = sigma/d; bodies move by sigma + f, so that d' = d + sigma + f. Roots are rewritten so that f is
/// right to round-off for any a and s.
#pragma once

#include <cassert>
#include <cmath>

#include "equidem/contact/laws/law.hpp"

namespace equidem::laws {

/// Later steps of a contact on the energy surface: (21), and (23) wherever (21) would give d' <= 0; modes 2 to 4.
inline ContactStep later_step(double depth, double closing, double a) {
  const double s = closing / depth;
  ContactStep step;
  step.mode = s > 0 ? 2 : 3;
  if (s * s < 1 - a) {
    const double w = (a + std::sqrt(a * a + (1 + a) * (s * s))) / (1 + a);  // -sigma'/d by (21), at most 1
    // For s <= 0 from (sigma' - sigma)(sigma' + sigma) = -a sigma' (sigma' + 2 d).
    step.change = s > 0 ? -(w * depth + closing) : -a * depth * w * (2 - w) / (w - s);
    return step;
  }
  if (s > 0) {  // (23)
    step.change = -(closing + std::sqrt(closing * closing + a * depth * depth));
  } else {
    step.mode = 4;
    step.change = -a * depth / (std::sqrt(s * s + a) - s);
  }
  return step;
}

/// The common members of the maps.
struct Map : LinearSpring {
  static constexpr LawKind kind = LawKind::map;
  static constexpr bool has_dashpot = false;
  static constexpr double steps_per_contact = 10;

  /// The restitution itself.
  static double dissipation(double restitution, ContactEnd /*end*/) { return checked_restitution(restitution); }
  static double damping_ratio(double /*restitution*/, ContactEnd /*end*/) { return 0; }
  /// Stable at any step; above omega dt = 1 a contact ends within a step.
  static double stable_step(double /*damping_ratio*/) { return 1; }
};

struct EnergyMap : Map {
  static constexpr const char* name = "energy_map";
  static constexpr const char* letter = "P";
  static constexpr const char* source = "Fujioka & Ushijima 2005 b";
  static constexpr const char* summary =
      "restitution at the first step of a contact, corrected to its true beginning; energy kept after it";

  /// (17), (20) with the corrected depth, (21), (23).
  /// \param first whether this is the first step of the contact
  static ContactStep step(double depth, double closing, double a, double restitution, bool first) {
    assert(depth > 0);
    if (!(first && closing > 0)) return later_step(depth, closing, a);
    // With t = 1/s: sigma^ = c sigma, d^ = c d (17); sigma' = sigma^/q (20); f = -sigma (q - c)/q without difference of
    // equals.
    const double e = restitution;
    const double t =
        std::fmin(depth / closing, 1e100);  // large only if `first` is set at a deep overlap; squares must not overflow
    const double at = a * t;
    const double r = std::sqrt(1 + at * t);
    const double less_c = (1 - e) + e * (at * t / (r * (1 + r)));                 // 1 - c
    const double more_q = at + (a + at * at) / (1 + std::sqrt(1 + a + at * at));  // q - 1
    ContactStep step;
    step.mode = 1;
    step.change = -closing * ((more_q + less_c) / (1 + more_q));
    step.shift = -depth * less_c;
    step.loss = (1 - e) * (1 + e) * closing * closing / 2;
    return step;
  }
};

}  // namespace equidem::laws
