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
/// With leapfrog the sum of kinetic and elastic energy oscillates by sway = h²/8 f.a, f the forces of springs, walls
/// and gravity, a the accelerations (free vibration: h²/8 a.M a, the share (omega h)²/4 of the elastic energy of a
/// mode). With this term the balance is exact to rounding if forces are linear in the motion. For finite motions and
/// for contacts with walls its error has the order of the integrator; the work of loads and supports is of second
/// order.
///
/// Colliding bodies: for maps and exact_flow all terms refer to one instant. For force laws with semi-implicit Euler,
/// velocities lag by half a step, and the potential of gravity is taken at the position of that instant.
struct EnergyLedger {
  double kinetic = 0;
  double elastic_bonded = 0;                          ///< contacts of bonded discs, their walls included
  double elastic_normal = 0, elastic_tangential = 0;  ///< contacts of colliding bodies
  double elastic_rolling = 0;                         ///< their rolling springs
  double cohesion = 0;                                ///< potential energy of their attraction, <= 0
  double elastic_bond = 0;                            ///< springs of bonds between colliding bodies
  double potential = 0;                               ///< gravity, 0 at the start
  double sway = 0;                                    ///< 0 at the start
  double damped_mass = 0, damped_contact = 0, damped_local = 0;
  double lost_restitution = 0;  ///< maps
  double lost_dashpot = 0;      ///< normal dashpots
  double lost_slip = 0, lost_tangential_dashpot = 0;
  double lost_rolling = 0;  ///< rolling friction and rolling dashpots
  /// Energy released at the end of a contact: tangential and rolling springs, and normal springs of contacts that end
  /// at zero force. With cohesion also what its force, which begins and ends at once, does in the step of a beginning
  /// or an end, less its potential energy there: of either sign, and of the first order of the step.
  double lost_release = 0;
  double lost_bond = 0;  ///< dashpots of bonds
  /// Released by bonds that broke: their springs, less what the contacts behind them store at once.
  double lost_breaking = 0;
  double work_of_loads = 0, work_of_supports = 0, work_of_walls = 0;
  double work_of_cell = 0;  ///< of the deformation of a periodic cell: stress times rate times area
  /// Kinetic and elastic energy that changes of the scene have added where a stage began.
  double work_of_stages = 0;
  double initial = 0;  ///< kinetic + elastic at the start

  [[nodiscard]] double elastic() const {
    return elastic_bonded + elastic_normal + elastic_tangential + elastic_rolling + elastic_bond;
  }
  [[nodiscard]] double lost() const;
  [[nodiscard]] double work() const;
  /// Error of the balance: stored - sway + lost - work - initial.
  [[nodiscard]] double error() const;
  /// The largest absolute value among kinetic, elastic, potential, cohesion, lost, work and initial: the scale of the
  /// error.
  [[nodiscard]] double largest() const;
};

enum class EnergyRole { stored, sway, lost, work, initial };

/// The families of simulations; each has its own terms.
enum class BodyFamily { bonded, colliding };

struct EnergyTerm {
  const char* key;    ///< key in files
  const char* label;  ///< label in reports
  EnergyRole role;
  double EnergyLedger::*value;
};

/// The terms of one family, or all terms, in the order of the files.
std::span<const EnergyTerm> energy_terms(BodyFamily family);
/// Them as the row of a saved state.
inline auto ledger_numbers(BodyFamily family) {
  return [family](auto& ledger, const auto& visit) {
    for (const EnergyTerm& term : energy_terms(family)) visit(ledger.*term.value);
  };
}
std::span<const EnergyTerm> energy_terms();

/// Energies at one time.
struct EnergySample {
  std::int64_t step = 0;
  double time = 0;  ///< s
  EnergyLedger ledger;
};

}  // namespace equidem
