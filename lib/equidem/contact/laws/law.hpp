// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The members of a law of normal contact.
///
/// A law is a struct without data in a file of its own and one line of laws/list.hpp; models to copy are
/// linear_dashpot.hpp for p = 1, hertz_dashpot.hpp for other p. A law without a member does not compile.
///
/// A force law is F = spring(k, d) + dashpot(c, d) v with the overlap d and the closing speed v. Loops over eight
/// contacts at a time evaluate it in SI units; loops over single contacts evaluate it without dimensions, as the maps
/// (Fujioka & Ushijima 2005, section 2): depth = d/d_c, sigma = v dt/d_c, a = k length_factor(d_c) dt²/m, forces in
/// units of m d_c/dt², m the reduced mass. Both see the same law because spring and dashpot are powers of d without a
/// length of their own:
///
///   spring_power            p of spring(k, d) = k d^p; length_factor(d) = d^(p - 1)
///   dashpot(c, d)           c d^((p - 1)/2): velocity against d^((p + 1)/2) is then that of a linear spring of
///                           stiffness 2 k/(p + 1) with dashpot, whose zeta gives the same restitution
///   damping_ratio(e, end)   that zeta; 0 without dashpot
///   dissipation(e, end)     c/sqrt(m k) = sqrt(2 (p + 1)) zeta; of maps the restitution
///   stiffness_from_overlap  k of an impact whose largest overlap is the given one
///   stable_step(zeta)       largest omega dt of one contact, omega² = p k d^(p - 1)/m at the largest overlap; 0: any
///   usual_end               where contacts end: at zero force, or at zero overlap
///   check_range(a, e)       throws Error (bad_input) where the law is not valid
///
/// The letter is one that no other law has.
#pragma once

#include "equidem/contact/exact_contact.hpp"
#include "equidem/contact/restitution.hpp"
#include "equidem/core/square_root.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

enum class LawKind {
  force,         ///< a force from overlap and closing speed; GrainOptions::Integrator sets the step
  map,           ///< the velocity after a step in place of a force, each contact by itself
  simultaneous,  ///< the law solves the step, all contacts together
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
/// \param c dimensionless dashpot coefficient, Law::dissipation sqrt(a)
/// \param attraction whether the force may pull; else it is cut at 0
template <class Law>
inline ContactStep force_step(double depth, double closing, double a, double c, bool attraction) {
  const double spring = -Law::spring(a, depth);
  double change = spring - Law::dashpot(c, depth) * closing;
  if (!attraction && change > 0) change = 0;
  return {0, change, 0, (spring - change) * closing};
}

namespace laws {

/// The linear spring F = k d, common to all laws but those of spheres.
struct LinearSpring {
  static constexpr double spring_power = 1;
  static constexpr const char* stiffness_unit = "N/m";
  static constexpr bool hertz_spring = false;
  static constexpr ContactEnd usual_end = ContactEnd::at_zero_force;

  static double length_factor(double /*length*/) { return 1; }
  /// W = k d²/2
  static double energy(double k, double d) { return 0.5 * k * d * d; }
  static ElasticImpact elastic_impact(double k, double m, double v) { return linear_impact(k, m, v); }
  static double stiffness_from_overlap(double overlap, double speed, double m, double damping_ratio) {
    return equidem::stiffness_from_overlap(overlap, speed, m, damping_ratio);
  }
  static void check_range(double /*a*/, double /*restitution*/) {}
};

/// F = k d + c v
struct LinearSpringDashpot : LinearSpring {
  static constexpr bool has_dashpot = true;

  /// c/sqrt(m k) = 2 zeta
  static double dissipation(double restitution, ContactEnd end) { return 2 * damping_ratio(restitution, end); }
  static double damping_ratio(double restitution, ContactEnd end) { return damping_ratio_of(restitution, end); }
};

}  // namespace laws

}  // namespace equidem
