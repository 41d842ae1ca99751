// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Spring, dashpot and limit of eight contacts, against slip and against rolling: impulse, losses and new stretch.
///
/// Rolling resistance and cohesion (contacts/contact_effects.hpp), as the response to a contact takes them. Rolling:
/// spring, dashpot and limit as of slip, of the velocity R (spin of j - spin of i). Cohesion: a contact lasts as long
/// as its gap is below the range, and begins and ends to press within that time.
#pragma once

#include "equidem/contact/sliding.hpp"
#include "equidem/core/simd.hpp"
#include "equidem/grains/contacts/contact_effects.hpp"

namespace equidem::eight {

/// Compile-time properties of a response.
struct ResponseKind {
  bool friction = false;
  bool verlet = false;
  bool equal = false;    ///< one law for all contacts, with a tangential spring where there is friction
  bool bounded = false;  ///< numbers of contacts apart are finite, and their law is equal: they give zeros unmasked
  // with friction, whose coefficient may be 0; neither equal nor bounded
  bool rolling = false;
  bool cohesion = false;
};

/// Which contacts act, begin and end in a step.
template <class Lanes>
struct ContactChanges {
  Bits<Lanes> touch, alive, begun, ended;
  bool any;    ///< some contact begins or ends
  bool first;  ///< first step of the simulation: where the contacts were before is not known
};

/// Losses of the tangential law in the drift in which contacts begin, where their first kick does half its work.
template <class Lanes>
struct FirstSlip {
  Lanes slip_loss, dashpot_loss;
};

/// \param drag impulse of the dashpot \param tangential impulse on j
template <class Lanes>
EQUIDEM_ALWAYS_INLINE FirstSlip<Lanes> first_slip_of(const SlidingLaw<Lanes>& law, const SlidingStep<Lanes>& tangent,
                                                     const Lanes& drag, const Lanes& tangential, const Lanes& mean_slip,
                                                     const Bits<Lanes>& begun) {
  const Lanes stored = law.half_spring * tangent.stretch * tangent.stretch;
  return {only(begun & tangent.slides, -(0.5 * tangential * mean_slip + stored)),
          only(begun & ~tangent.slides, 0.5 * drag * mean_slip)};
}

/// J; `released` is what the springs of ended contacts held.
template <class Lanes>
struct SpringLosses {
  Lanes slip, dashpot, released;
};

/// \tparam Tangential as CoulombSpring
/// \param dashpot times dt, kg
/// \param velocity of j relative to i, with half of the change by this contact in the last step (Euler)
/// \param mean_velocity Verlet: over the drift
/// \param mobility Euler: mean velocity per impulse, 1/kg
/// \param repulsion impulse that the limit is measured by
/// \param[in,out] impulse on j
/// \param[in,out] stretch of the spring, m
/// \param[in,out] losses 0 before
template <class Tangential, ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE void resist(const SlidingLaw<Lanes>& law, const Lanes& dashpot, Lanes velocity,
                                  const Lanes& mean_velocity, const Lanes& mobility, const Lanes& repulsion,
                                  const ContactChanges<Lanes>& at, double dt, Lanes& impulse, Lanes& stretch,
                                  SpringLosses<Lanes>& losses) {
  const Bits<Lanes>& touch = at.touch;
  Lanes stretched = stretch;
  if constexpr (kind.verlet) {
    if (at.any || at.first) [[unlikely]]  // its place before is not known: the slip at the instant is that of the step
      stretched += only(at.first ? touch : at.begun, (velocity - mean_velocity) * dt);
  } else {
    velocity -= mobility * impulse;  // without this contact's own part in it
  }
  const Lanes yield = law.friction * larger(repulsion, Lanes{});
  SlidingStep<Lanes> tangent = Tangential::template step<kind.verlet, kind.equal>(
      law, dashpot, stretched, velocity, mean_velocity, mobility, impulse, yield, dt);
  if constexpr (!kind.bounded) {
    tangent.impulse = only(touch, tangent.impulse);
    tangent.stretch = only(touch, tangent.stretch);
  }
  const Lanes on_j = -tangent.impulse;
  if (at.any || !kind.bounded) {
    const Bits<Lanes> lasting = kind.verlet ? touch & at.alive : touch;
    tangent.slip_loss = only(lasting, tangent.slip_loss);
    tangent.dashpot_loss = only(lasting, tangent.dashpot_loss);
  }
  if (at.any) [[unlikely]] {
    losses.released = law.half_spring * stretched * stretched;
    if constexpr (kind.verlet) {
      const FirstSlip<Lanes> first = first_slip_of(law, tangent, dashpot * velocity, on_j, mean_velocity, at.begun);
      tangent.slip_loss += first.slip_loss;
      tangent.dashpot_loss += first.dashpot_loss;
      losses.released -= 0.5 * impulse * mean_velocity;
    }
    losses.released = only(at.ended, losses.released);
  }
  losses.slip = tangent.slip_loss;
  losses.dashpot = tangent.dashpot_loss;
  impulse = on_j;
  stretch = tangent.stretch;
}

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
  resist<CoulombSpring, kind>(of.spring, of.dashpot, of.velocity, of.velocity, of.mobility, repulsion, at, dt,
                              memory.impulse, memory.stretch, losses);
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
