// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Spring, dashpot and limit of eight contacts, against slip and against rolling: impulse, losses and new stretch.
#pragma once

#include "equidem/contact/sliding.hpp"
#include "equidem/core/simd.hpp"

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

/// \param dashpot times dt, kg
/// \param velocity of j relative to i, with half of the change by this contact in the last step (Euler)
/// \param mean_velocity Verlet: over the drift
/// \param mobility Euler: mean velocity per impulse, 1/kg
/// \param repulsion impulse that the limit is measured by
/// \param[in,out] impulse on j
/// \param[in,out] stretch of the spring, m
/// \param[in,out] losses 0 before
template <ResponseKind kind, class Lanes>
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
  SlidingStep<Lanes> tangent =
      slide<kind.verlet, kind.equal>(law, dashpot, stretched, velocity, mean_velocity, mobility, impulse, yield, dt);
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

}  // namespace equidem::eight
