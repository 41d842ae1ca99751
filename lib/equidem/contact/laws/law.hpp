// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The pieces of a law of normal contact.
///
/// A law is a struct without data: its `facts`, and the function by which its kind steps a contact: spring and dashpot
/// of a force law, step of a map, step of the simultaneous law (laws.hpp).
///
/// A force law is F = spring(k, d) + dashpot(c, d) v with the overlap d and the closing speed v. Loops over eight
/// contacts at a time evaluate it in SI units; loops over single contacts evaluate it without dimensions, as the maps
/// (Fujioka & Ushijima 2005, section 2): depth = d/d_c, sigma = v dt/d_c, a = k length_factor(d_c) dt²/m, forces in
/// units of m d_c/dt², m the reduced mass. Both see the same law because spring and dashpot are powers of d without a
/// length of their own: spring(k, d) = k d^p, dashpot(c, d) = c d^((p - 1)/2). It names its law of slip, Tangential, a
/// struct with the function of CoulombSpring (sliding.hpp), which maps and simultaneous laws take.
#pragma once

#include "equidem/contact/exact_contact.hpp"
#include "equidem/contact/restitution.hpp"
#include "equidem/contact/sliding.hpp"
#include "equidem/core/square_root.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

enum class LawKind {
  force,         ///< a force from overlap and closing speed; GrainOptions::Integrator sets the step
  map,           ///< the velocity after a step in place of a force, each contact by itself
  simultaneous,  ///< the law solves the step, all contacts together
};

/// A law but for its step. Where nothing else is said: the linear spring F = k d and the dashpot c v.
struct LawFacts {
  const char* name = "";    ///< as in case files
  const char* letter = "";  ///< one that no other law has
  const char *source = "", *summary = "";
  LawKind kind = LawKind::force;
  bool has_dashpot = true;
  ContactEnd usual_end = ContactEnd::at_zero_force;
  double spring_power = 1;  ///< p of spring(k, d) = k d^p
  const char* stiffness_unit = "N/m";
  bool hertz_spring = false;
  double steps_per_contact = 50;  ///< where no time step is given
  /// d^(p - 1)
  double (*length_factor)(double length) = [](double) { return 1.0; };
  /// W, k d²/2 of the linear spring.
  double (*energy)(double k, double d) = [](double k, double d) { return 0.5 * k * d * d; };
  ElasticImpact (*elastic_impact)(double k, double m, double v) = linear_impact;
  /// k of an impact whose largest overlap is the given one.
  double (*stiffness_from_overlap)(double overlap, double speed, double m,
                                   double damping_ratio) = equidem::stiffness_from_overlap;
  /// c/sqrt(m k) = sqrt(2 (p + 1)) zeta; of maps the restitution.
  double (*dissipation)(double restitution, ContactEnd end) = [](double restitution, ContactEnd end) {
    return 2 * damping_ratio_of(restitution, end);
  };
  /// zeta of the linear spring of stiffness 2 k/(p + 1) with dashpot that has the same restitution: velocity against
  /// d^((p + 1)/2) is the same. 0 without dashpot.
  double (*damping_ratio)(double restitution, ContactEnd end) = damping_ratio_of;
  /// Largest omega dt of one contact, omega² = p k d^(p - 1)/m at the largest overlap; 0: any. Of the linear spring and
  /// dashpot 2/(sqrt(1 + zeta²) + zeta).
  double (*stable_step)(double damping_ratio) = semi_implicit_limit;
  /// \throws Error (bad_input) where the law is not valid
  void (*check_range)(double a, double restitution) = [](double, double) {};
  /// Constants of a pair, of simultaneous laws alone.
  ExactPair (*prepare)(double m, double k, double dissipation, ContactEnd end, double dt) = nullptr;
};

/// Dimensionless change of one contact in one step.
struct ContactStep {
  /// Maps: 1 first step (10, 11: five_case_map, 1a and 1b), 2 deepening, 3 still touching, 4 parting; else 0.
  int mode = 0;
  double change = 0;  ///< f, of sigma
  double shift = 0;   ///< of the depth before the step, d^ - d: positions move by it (energy_map, mode 1; else 0)
  /// Energy lost by restitution or dashpot, >= 0, in units of m d_c²/dt²; maps: exact, forces: power at the start.
  double loss = 0;
};

/// One step of a force law.
/// \param c dimensionless dashpot coefficient, LawFacts::dissipation sqrt(a)
/// \param attraction whether the force may pull; else it is cut at 0
template <class Law>
inline ContactStep force_step(double depth, double closing, double a, double c, bool attraction) {
  const double spring = -Law::spring(a, depth);
  double change = spring - Law::dashpot(c, depth) * closing;
  if (!attraction && change > 0) change = 0;
  return {0, change, 0, (spring - change) * closing};
}

}  // namespace equidem
