// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The energy ledger of a simulation: named terms, and the balance that follows from their roles.
#pragma once

#include <cstdint>
#include <span>

namespace equidem {

/// Energies at one time, J (spheres) or J per metre of depth (discs); losses and work are counted from the start. A
/// simulation leaves the terms that it does not have at 0.
///
/// Leapfrog does not keep the sum of kinetic and elastic energy, it lets it sway: by sway = h²/8 f.a, f the forces of
/// springs, walls and gravity, a the accelerations (free vibration: h²/8 a.M a, the share (omega h)²/4 of the elastic
/// energy of a mode). With it the balance is exact but for rounding where forces are linear in the motion; for finite
/// motions and discs that meet walls it closes to the order of the integrator, work of loads and supports to the
/// second.
///
/// Of colliding bodies, maps and exact_flow keep all terms to one instant; the force laws by Euler keep velocities half
/// a step behind, and the potential of gravity is taken where the body was then.
struct EnergyLedger {
  double kinetic = 0;
  double elastic_bonded = 0;                          ///< contacts of bonded discs, their walls included
  double elastic_normal = 0, elastic_tangential = 0;  ///< contacts of colliding bodies
  double elastic_bond = 0;                            ///< springs of bonds between colliding bodies
  double potential = 0;                               ///< gravity, 0 at the start
  double sway = 0;                                    ///< 0 at the start
  double damped_mass = 0, damped_contact = 0, damped_local = 0;
  double lost_restitution = 0;  ///< maps
  double lost_dashpot = 0;      ///< normal
  double lost_slip = 0, lost_tangential_dashpot = 0;
  /// Tangential springs, and normal springs of contacts that end at zero force, released at the end of a contact.
  double lost_release = 0;
  double lost_bond = 0;  ///< dashpots of bonds
  double work_of_loads = 0, work_of_supports = 0, work_of_walls = 0;
  double initial = 0;  ///< kinetic + elastic at the start

  [[nodiscard]] double elastic() const { return elastic_bonded + elastic_normal + elastic_tangential + elastic_bond; }
  [[nodiscard]] double lost() const;
  [[nodiscard]] double work() const;
  /// Error of the balance: stored - sway + lost - work - initial.
  [[nodiscard]] double error() const;
  /// The largest absolute value among kinetic, elastic, potential, lost, work and initial: the scale of the error.
  [[nodiscard]] double largest() const;
};

enum class EnergyRole { stored, sway, lost, work, initial };

/// The families of simulations: each has its own terms.
enum class BodyFamily { bonded, colliding };

struct EnergyTerm {
  const char* key;    ///< in files
  const char* label;  ///< in reports
  EnergyRole role;
  double EnergyLedger::*value;
};

/// The terms of a family, in the order in which files list them; all terms.
std::span<const EnergyTerm> energy_terms(BodyFamily family);
std::span<const EnergyTerm> energy_terms();

/// Energies at a moment.
struct EnergySample {
  std::int64_t step = 0;
  double time = 0;  ///< s
  EnergyLedger ledger;
};

}  // namespace equidem
