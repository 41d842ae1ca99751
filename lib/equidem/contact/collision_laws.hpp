// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Normal contact in one step, dimensionless as in Fujioka & Ushijima (2005), section 2.
///
/// depth d = overlap/d_c > 0, closing sigma = p + q = closing speed dt/d_c, slope s = sigma/d. A law gives the change f
/// of sigma; bodies then move by sigma + f: d' = d + sigma + f. The force is f m d_c/dt², m the reduced mass. a = k
/// dt²/m > 0 (k d_c^(1/2) dt²/m of Hertz). The maps keep (sigma² + a d²)/2 but for the loss they report; their roots
/// are rewritten so that f is right to round-off for any a and s.
#pragma once

#include <cassert>
#include <cmath>
#include <string>

namespace equidem {

/// The laws of normal contact.
enum class NormalLaw {
  linear_dashpot,  ///< "linear_dashpot", the paper's C (Cundall & Strack 1979): linear spring and dashpot
  hertz_dashpot,   ///< "hertz_dashpot", T (Tanaka, Ishida & Tsuji 1991): Hertz spring, dashpot with d^(1/4)
  five_case_map,   ///< "five_case_map", F (Fujioka & Ushijima 2005 a): restitution at the first step of contact, then
                   ///< energy kept
  energy_map,  ///< "energy_map", P (Fujioka & Ushijima 2005 b): the first step corrected to the true instant of contact
  exact_flow,  ///< "exact_flow": the linear spring and dashpot solved exactly within the step, contacts together
               ///< (exact_contact.hpp)
};

/// \throws Error (bad_input) naming the choices
NormalLaw normal_law_from(const std::string& name);
std::string to_string(NormalLaw law);
/// "C", "T", "F", "P", "X".
std::string letter_of(NormalLaw law);
/// Whether a law takes a map from step to step (five_case_map, energy_map) in place of a force.
constexpr bool is_map(NormalLaw law) {
  return law == NormalLaw::five_case_map || law == NormalLaw::energy_map;
}

/// What a contact does in one step.
struct ContactStep {
  int mode =
      0;  ///< maps: 1 first step (10, 11: five_case_map, 1a and 1b), 2 deepening, 3 still touching, 4 parting; else 0
  double change = 0;  ///< f: of sigma, all of it
  double shift = 0;   ///< of the depth before the step, d^ - d (energy_map, mode 1; else 0): positions move by it
  double loss = 0;  ///< of energy, by restitution or dashpot, >= 0, in units of m d_c²/dt²; maps: exact, forces: power
                    ///< at the start
};

/// C: f = -a d - 2 zeta sqrt(a) sigma; cut to f <= 0 where the contact ends at zero force.
inline ContactStep linear_dashpot_step(double depth, double closing, double a, double zeta, bool attraction);

/// T: f = -a d^(3/2) - alpha sqrt(a) d^(1/4) sigma; attraction as above.
inline ContactStep hertz_dashpot_step(double depth, double closing, double a, double alpha, bool attraction);

/// P, eqs. (17), (20) with the corrected depth, (21), (23); leaves by (23) wherever (21) would give d' <= 0.
/// \param first first step of this contact
inline ContactStep energy_map_step(double depth, double closing, double a, double restitution, bool first);

/// F: the first step accepted as it is; leaves at once with -e sigma where s >= 1/e, else the lower root with the
/// energy less (1 - e²) sigma²/2; later steps as P.
inline ContactStep five_case_map_step(double depth, double closing, double a, double restitution, bool first);

/// The same where nothing is known of the step before: first means s >= 1, the bodies were apart before they moved by
/// sigma. A contact that starts with d = 0 exactly has s = 1 but for round-off, which decides: the caller who knows
/// better should say.
inline ContactStep energy_map_step(double depth, double closing, double a, double restitution) {
  return energy_map_step(depth, closing, a, restitution, closing >= depth);
}
inline ContactStep five_case_map_step(double depth, double closing, double a, double restitution) {
  return five_case_map_step(depth, closing, a, restitution, closing >= depth);
}

/// F is real for every slope only where e² >= a/(1 + a).
/// \throws Error (bad_input) naming both numbers and the remedy
void check_five_case_range(double a, double restitution);

namespace detail {

/// Spring and dashpot, both as changes of sigma.
inline ContactStep force_step(double spring, double dashpot, double closing, bool attraction) {
  double change = spring + dashpot;
  if (!attraction && change > 0) change = 0;
  return {0, change, 0, (spring - change) * closing};
}

/// Modes 2 to 4 on the energy surface.
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

}  // namespace detail

inline ContactStep linear_dashpot_step(double depth, double closing, double a, double zeta, bool attraction) {
  return detail::force_step(-a * depth, -2 * zeta * std::sqrt(a) * closing, closing, attraction);
}

inline ContactStep hertz_dashpot_step(double depth, double closing, double a, double alpha, bool attraction) {
  const double root = std::sqrt(depth);
  return detail::force_step(-a * depth * root, -alpha * std::sqrt(a * root) * closing, closing, attraction);
}

inline ContactStep energy_map_step(double depth, double closing, double a, double restitution, bool first) {
  assert(depth > 0);
  if (!(first && closing > 0)) return detail::later_step(depth, closing, a);
  // With t = 1/s: sigma^ = c sigma, d^ = c d (17); sigma' = sigma^/q (20); f = -sigma (q - c)/q without difference of
  // equals.
  const double e = restitution;
  const double t =
      std::fmin(depth / closing, 1e100);  // far above 1 only where the caller says first; squares must not overflow
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

inline ContactStep five_case_map_step(double depth, double closing, double a, double restitution, bool first) {
  assert(depth > 0);
  if (!(first && closing > 0)) return detail::later_step(depth, closing, a);
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

}  // namespace equidem
