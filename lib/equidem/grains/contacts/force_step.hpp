// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Steps in which every contact is evaluated by itself: force laws and maps.
///
/// The contacts of a step in scenes with ellipses or clumps.
///
/// A step of a simultaneous law (exact_flow): all contacts together.
///
/// Each contact is solved exactly over the step (exact_contact.hpp) under an outside force that is linear in time and
/// has the impulse and the first moment of all other forces on its two bodies; sweeps over the contacts repeat this
/// until convergence. The normal is the mean normal of the step, (r + r')/|r + r'|, and the displacement along it is
/// scaled to the change of the distance: the step is reversible in time, and elastic impacts conserve energy on
/// average.
///
/// The tangential force is constant over the step, its spring stretched by the way of the bodies, the moments of normal
/// forces included: slow loads lead to the forces of statics at any step.
#pragma once

#include <algorithm>

#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// The loop compiled for a map, or over contacts with walls by a force law in Verlet schemes, with or without friction:
/// impulses of this step from positions and velocities. Null for a simultaneous law.
CandidateLoop candidate_loop(NormalLaw law, bool friction);

/// The loop over contacts of discs with walls by a force law and semi-implicit Euler, eight at a time; null in other
/// scenes.
CandidateLoop wall_loop(const GrainSystem& system);

/// Count a contact that acts in this step.
inline void count_contact(const Candidate& candidate, double overlap, BlockSums& sums) {
  if (!candidate.touching) ++sums.contacts;
  ++sums.evaluations;
  sums.deepest = std::max(sums.deepest, overlap);
}

/// Energy lost in the dashpot of a contact in a step, J, and that lost by the spring where attraction is cut: the force
/// times the mean velocity of the step, of second order in the step. The velocity change by other forces is taken from
/// the previous step of the contact. \param candidate state after the last step
/// \param depth, unit, unit_speed overlap over the length, and the units of step.change as impulse and as speed
/// \param eccentric the reduced mass over the effective mass of the contact points along the normal: 1 if the normal
///        passes through both centres
template <class Law>
double dashpot_heat(const Candidate& candidate, const ContactStep& step, double depth, double closing, double unit,
                    double unit_speed, double eccentric = 1) {
  const double spring = -Law::spring(candidate.a, depth);
  const double by_others =
      candidate.steps > 0 ? closing - candidate.closing + eccentric * candidate.impulse / candidate.reduced_mass : 0;
  return (spring - step.change) * unit * (closing + 0.5 * (eccentric * step.change * unit_speed + by_others));
}

/// Set system.bodies.next of a block from the impulses: v' = v + a dt, x' = x + v' dt (+ the shifts of maps); and
/// system.bodies.ways.
void move_by_euler(GrainSystem& system, std::size_t block);

/// Set system.bodies.next: half kick by the impulses of the last step, then the drift.
void drift_of_verlet(GrainSystem& system);
/// Second half kick of a block, by the impulses computed from the velocities at the half step.
void kick_of_verlet(GrainSystem& system, std::size_t block);

/// The loop over contacts of parts compiled for a force law, with or without friction; null for other laws.
///
/// An impulse p at the contact point exerts arm x p on both bodies; velocities are those of the material points there.
/// Stiffness and dashpot are those of a central impact: c = 2 zeta sqrt(m k) with 1/m = 1/m_i + 1/m_j, without the arms
/// (Sukegawa 2010, (2.27)). An eccentric impact has the smaller mass m', 1/m' = 1/m + (arm_i x n)²/I_i + (arm_j x
/// n)²/I_j: its duration is shorter by sqrt(m'/m), and zeta' = zeta sqrt(m/m') makes its restitution smaller than
/// prescribed. The tangential dashpot is 2 zeta_T sqrt(m_T kT) with the tangential mass of the present arms.
CandidateLoop part_candidate_loop(NormalLaw law, bool friction);

/// The step compiled for a simultaneous law; it sets system.bodies.next and the state of the contacts. Null for other
/// laws. The step throws:
/// \throws Error (computation_failed) if sweeps do not converge or bodies would pass through one another; the contacts
///         keep the state of the failed step
using FlowFunction = void (*)(GrainSystem&);
FlowFunction flow_function(NormalLaw law);

}  // namespace equidem
