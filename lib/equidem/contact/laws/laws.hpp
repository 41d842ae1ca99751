// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The laws of normal contact, and the only list of them. NormalLaw, the loops over contacts, the choices and help of
/// the case file and the reports follow from it.
///
/// To add a law, write a struct that has the pieces of laws/law.hpp and add a line to the list; models to copy are
/// LinearDashpot for p = 1, HertzDashpot for other p.
#pragma once

#include <cassert>
#include <cmath>
#include <numbers>

#include "equidem/contact/laws/law.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem::laws {

/// F = k d + c v, c = 2 zeta sqrt(m k) (Cundall & Strack 1979; the law C of Fujioka & Ushijima 2005).
struct LinearDashpot {
  using Tangential = CoulombSpring;
  static constexpr LawFacts facts = {.name = "linear_dashpot",
                                     .letter = "C",
                                     .source = "Cundall & Strack 1979",
                                     .summary = "linear spring and dashpot"};

  template <class Number>
  [[gnu::always_inline]] static Number spring(const Number& k, const Number& d) {
    return k * d;
  }
  template <class Number>
  [[gnu::always_inline]] static Number dashpot(const Number& c, const Number& /*d*/) {
    return c;
  }
};

/// F = k d^(3/2) + c d^(1/4) v, c = alpha sqrt(m k) (Tanaka, Ishida & Tsuji 1991; the law T of Fujioka & Ushijima
/// 2005). Velocity against d^(5/4) is that of a linear spring and dashpot with zeta = alpha/sqrt(5): the restitution
/// does not depend on the speed, and is exact for either end of the contact.
struct HertzDashpot {
  using Tangential = CoulombSpring;
  static constexpr LawFacts facts = {
      .name = "hertz_dashpot",
      .letter = "T",
      .source = "Tanaka, Ishida & Tsuji 1991",
      .summary = "Hertz spring and dashpot",
      .usual_end = ContactEnd::at_zero_overlap,
      .spring_power = 1.5,
      .stiffness_unit = "N/m^1.5",
      .hertz_spring = true,
      .length_factor = [](double length) { return std::sqrt(length); },
      // W = 2/5 k d^(5/2)
      .energy = [](double k, double d) { return 0.4 * k * d * d * std::sqrt(d); },
      .elastic_impact = hertz_impact,
      // Without damping: 5 m v²/(4 u^(5/2)).
      .stiffness_from_overlap =
          [](double overlap, double speed, double m, double /*damping_ratio*/) {
            return 1.25 * m * speed * speed / std::pow(overlap, 2.5);
          },
      // c/sqrt(m k) = alpha = sqrt(5) zeta
      .dissipation = hertz_damping_of,
      .damping_ratio = [](double restitution,
                          ContactEnd end) { return hertz_damping_of(restitution, end) / std::sqrt(5.0); },
      // With the tangent stiffness 3/2 k d^(1/2) at the largest overlap. The dashpot alpha sqrt(m k) d^(1/4) over the
      // critical one of that stiffness is sqrt(5/6) zeta.
      .stable_step = [](double damping_ratio) { return semi_implicit_limit(std::sqrt(5.0 / 6) * damping_ratio); }};

  template <class Number>
  [[gnu::always_inline]] static Number spring(const Number& k, const Number& d) {
    return k * d * square_root(d);
  }
  template <class Number>
  [[gnu::always_inline]] static Number dashpot(const Number& c, const Number& d) {
    return c * square_root(square_root(d));
  }
};

/// Linear spring and dashpot solved exactly within the step, all contacts together (exact_contact.hpp,
/// grains/contacts/flow_step.hpp).
struct ExactFlow {
  static constexpr LawFacts facts = {
      .name = "exact_flow",
      .letter = "X",
      .summary = "linear spring and dashpot solved exactly within the step, all contacts together",
      .kind = LawKind::simultaneous,
      .steps_per_contact = std::numbers::pi,                        // omega dt = 1
      .stable_step = [](double /*damping_ratio*/) { return 0.0; },  // a single contact is exact at any step
      .prepare = [](double m, double k, double dissipation, ContactEnd end,
                    double dt) { return exact_pair(m, k, dissipation / 2, end, dt); }};

  static ExactStep step(const ExactPair& pair, double overlap, double closing, bool touching, double h0, double h1) {
    return exact_step(pair, overlap, closing, touching, h0, h1);
  }
};

/// Facts that hold for all maps: they are stable at any step; above omega dt = 1 a contact ends within a step.
constexpr LawFacts facts_of_map(LawFacts facts) {
  facts.kind = LawKind::map;
  facts.has_dashpot = false;
  facts.steps_per_contact = 10;
  facts.dissipation = [](double restitution, ContactEnd /*end*/) { return checked_restitution(restitution); };
  facts.damping_ratio = [](double /*restitution*/, ContactEnd /*end*/) { return 0.0; };
  facts.stable_step = [](double /*damping_ratio*/) { return 1.0; };
  return facts;
}

/// Later steps of a contact of both maps, on the energy surface: (21), and (23) wherever (21) would give d' <= 0; modes
/// 2 to 4 (Fujioka & Ushijima 2005 b). Slope s = sigma/d; bodies move by sigma + f, so that d' = d + sigma + f.
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

/// The map P of Fujioka & Ushijima (2005 b), section 2: the first step of a contact is corrected to the true instant at
/// which it began and loses energy according to the restitution; later steps conserve (sigma² + a d²)/2. Roots are
/// rewritten so that f is right to round-off for any a and s.
struct EnergyMap {
  static constexpr LawFacts facts = facts_of_map(
      {.name = "energy_map",
       .letter = "P",
       .source = "Fujioka & Ushijima 2005 b",
       .summary = "restitution at the first step of a contact, corrected to its true beginning; energy kept after it"});

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

/// The map F of Fujioka & Ushijima (2005 a): restitution at the first step of contact, accepted as it is; energy kept
/// after it.
struct FiveCaseMap {
  /// The first step is real for every slope only where e² >= a/(1 + a).
  /// \throws Error (bad_input) naming both numbers and the remedy
  static void check_range(double a, double restitution) {
    if (restitution * restitution * (1 + a) >= a) return;
    bad_input(fmt::format("the law five_case_map is asked for restitution {:.6g} at dimensionless stiffness a = {:.6g}",
                          restitution, a),
              fmt::format("its first step has an answer only where e² >= a/(1 + a), that is e >= {:.6g}",
                          std::sqrt(a / (1 + a))),
              fmt::format("Choose energy_map, which takes any restitution, or an a of at most {:.6g}",
                          restitution * restitution / ((1 - restitution) * (1 + restitution))));
  }

  static constexpr LawFacts facts =
      facts_of_map({.name = "five_case_map",
                    .letter = "F",
                    .source = "Fujioka & Ushijima 2005 a",
                    .summary = "restitution at the first step of a contact, energy kept after it",
                    .check_range = check_range});

  /// The contact leaves at once with -e sigma where s >= 1/e, else by the lower root with the energy less
  /// (1 - e²) sigma²/2; later steps as energy_map.
  /// \param first whether this is the first step of the contact
  static ContactStep step(double depth, double closing, double a, double restitution, bool first) {
    assert(depth > 0);
    if (!(first && closing > 0)) return later_step(depth, closing, a);
    const double e = restitution;
    ContactStep step;
    step.loss = (1 - e) * (1 + e) * closing * closing / 2;
    if (e * closing >= depth) {
      step.mode = 10;
      step.change = -(1 + e) * closing;
    } else {
      step.mode = 11;
      const double square = (1 + a) * (e * closing) * (e * closing) - a * depth * depth;
      step.change = -(a * depth + std::sqrt(square > 0 ? square : 0)) / (1 + a) - closing;
    }
    return step;
  }
};

}  // namespace equidem::laws

// clang-format off
/// Name in case files, struct: one line for each law.
#define EQUIDEM_LAWS(law)            \
  law(exact_flow, ExactFlow)         \
  law(linear_dashpot, LinearDashpot) \
  law(hertz_dashpot, HertzDashpot)   \
  law(five_case_map, FiveCaseMap)    \
  law(energy_map, EnergyMap)
// clang-format on
