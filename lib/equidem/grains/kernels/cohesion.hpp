// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cohesion of eight contacts (contacts/contact_effects.hpp): a contact lasts as long as its gap is below the range, and
/// begins and ends to press within that time.
#pragma once

#include "equidem/grains/contacts/contact_effects.hpp"
#include "equidem/grains/kernels/resist.hpp"

namespace equidem::eight {

template <class Lanes>
struct CohesionLanes {
  Lanes attraction;  ///< times dt, N s
  Lanes range;       ///< m
};

template <class Lanes>
EQUIDEM_ALWAYS_INLINE CohesionLanes<Lanes> cohesion_lanes(const ContactEffects& of) {
  return {load<Lanes>(of.attraction), load<Lanes>(of.range)};
}

/// Where spring and dashpot act, of the contacts in range.
/// \param motion ContactMotion
template <ResponseKind kind, class Lanes, class Motion>
EQUIDEM_ALWAYS_INLINE ContactChanges<Lanes> pressing(const ContactChanges<Lanes>& near, const Motion& motion) {
  ContactChanges<Lanes> at = near;
  at.touch = near.touch & negative(Lanes{} - motion.overlap);
  // Euler: whether it pressed before is not known, nor needed
  if constexpr (kind.verlet) at.alive = near.alive & negative(Lanes{} - motion.overlap_before);
  at.begun = at.touch & ~at.alive;
  at.ended = at.alive & ~at.touch;
  at.any = eight::any(at.begun | at.ended);
  return at;
}

/// What is lost as contacts enter and leave the range. The ledger counts a potential energy that is linear in the gap,
/// at the time of the velocities, half the way of a step behind: there it begins and ends at once.
template <ResponseKind kind, class Lanes, class Motion>
EQUIDEM_ALWAYS_INLINE Lanes lost_at_range(const CohesionLanes<Lanes>& of, const Motion& motion,
                                          const ContactChanges<Lanes>& near, double dt) {
  if (!near.any) return Lanes{};
  const Lanes& closing = kind.verlet ? motion.mean_closing : motion.closing;
  const Lanes energy = (1 / dt) * of.attraction * (motion.overlap + of.range - (0.5 * dt) * closing);
  return only(near.begun, energy) - only(near.ended, energy);
}

}  // namespace equidem::eight
