// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rolling resistance and cohesion of eight contacts (contacts/contact_effects.hpp), as the response to a contact takes
/// them.
///
/// Rolling: spring, dashpot and limit as of slip, of the velocity R (spin of j - spin of i).
///
/// Cohesion: a contact lasts as long as its gap is below the range, and begins and ends to press within that time.
#pragma once

#include "equidem/grains/contacts/contact_effects.hpp"
#include "equidem/grains/kernels/resist.hpp"

namespace equidem::eight {

template <class Lanes>
struct RollingLanes {
  SlidingLaw<Lanes> spring;
  Lanes dashpot;   ///< times dt, kg
  Lanes mobility;  ///< mean velocity per impulse, 1/kg
  Lanes velocity;  ///< of rolling, as that of resist()
  Lanes lost;      ///< found by roll(), J
};

/// The state of rolling, kept from step to step.
template <class Lanes>
struct RollingMemory {
  Lanes impulse;  ///< on j at the lever, N s
  Lanes stretch;  ///< m
};

template <class Lanes>
EQUIDEM_ALWAYS_INLINE RollingLanes<Lanes> rolling_lanes(const ContactEffects& of, const Lanes& velocity, double dt) {
  return {sliding_law(load<Lanes>(of.friction), load<Lanes>(of.stiffness), dt), load<Lanes>(of.dashpot),
          load<Lanes>(of.half_mobility), velocity, Lanes{}};
}

template <class Lanes>
EQUIDEM_ALWAYS_INLINE RollingMemory<Lanes> rolling_memory(const ContactEffects& of) {
  return {load<Lanes>(of.impulse), load<Lanes>(of.stretch)};
}

using simd::store;
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void store(const RollingMemory<Lanes>& memory, ContactEffects& of) {
  store(memory.impulse, of.impulse);
  store(memory.stretch, of.stretch);
}

/// \param repulsion impulse
/// \return what springs of ended contacts held, J
template <ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes roll(RollingLanes<Lanes>& of, const Lanes& repulsion, const ContactChanges<Lanes>& at,
                                 double dt, RollingMemory<Lanes>& memory) {
  SpringLosses<Lanes> losses{};
  resist<kind>(of.spring, of.dashpot, of.velocity, of.velocity, of.mobility, repulsion, at, dt, memory.impulse,
               memory.stretch, losses);
  of.lost = losses.slip + losses.dashpot;
  return losses.released;
}

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

/// The energy lost as contacts enter and leave the range. The ledger counts a potential energy that is linear in the
/// gap, at the time of the velocities, half the way of a step behind: there it begins and ends at once.
template <ResponseKind kind, class Lanes, class Motion>
EQUIDEM_ALWAYS_INLINE Lanes lost_at_range(const CohesionLanes<Lanes>& of, const Motion& motion,
                                          const ContactChanges<Lanes>& near, double dt) {
  if (!near.any) return Lanes{};
  const Lanes& closing = kind.verlet ? motion.mean_closing : motion.closing;
  const Lanes energy = (1 / dt) * of.attraction * (motion.overlap + of.range - (0.5 * dt) * closing);
  return only(near.begun, energy) - only(near.ended, energy);
}

/// The numbers of both effects; only those that the kind has are set.
template <class Lanes>
struct EffectLanes {
  RollingLanes<Lanes> rolling;
  CohesionLanes<Lanes> cohesion;
};

/// The response of a scene that has some.
template <bool verlet>
constexpr ResponseKind with_effects{.friction = true, .verlet = verlet, .rolling = true, .cohesion = true};

/// The effects of a group; null in loops that do not read them.
template <ResponseKind kind>
EQUIDEM_ALWAYS_INLINE ContactEffects* effects_at(ContactEffects* effects, std::size_t group) {
  return kind.rolling || kind.cohesion ? effects + group : nullptr;
}

}  // namespace equidem::eight
