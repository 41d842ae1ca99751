// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Spring, dashpot and limit of eight contacts, against slip and against rolling: impulse, losses and new stretch.
#pragma once

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

/// Constants of springs with a limit.
template <class Lanes>
struct SpringLanes {
  Lanes friction;     ///< mu
  Lanes half_spring;  ///< k/2, N/m
  Lanes spring;       ///< k dt, N s/m
  Lanes rate;         ///< k dt²/2, kg
  Lanes slack;        ///< 1/(k dt), m/(N s); finite without a spring, too
};

/// \param stiffness k, N/m
/// \param compliance 1/k, m/N
template <class Lanes>
EQUIDEM_ALWAYS_INLINE SpringLanes<Lanes> spring_lanes(const Lanes& friction, const Lanes& stiffness,
                                                      const Lanes& compliance, double dt) {
  return {friction, 0.5 * stiffness, dt * stiffness, (0.5 * dt * dt) * stiffness, (1 / dt) * compliance};
}
/// Likewise where some contacts have no spring.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE SpringLanes<Lanes> spring_lanes(const Lanes& friction, const Lanes& stiffness, double dt) {
  return spring_lanes(friction, stiffness, 1 / choose(negative(Lanes{} - stiffness), stiffness, all<Lanes>(1)), dt);
}

template <class Lanes>
struct Tangent {
  Lanes impulse, stretch, slip_loss, dashpot_loss;
  Bits<Lanes> slides;
};

/// sliding_step (verlet) and sliding_step_midpoint for contacts that have a spring, or no friction.
/// \tparam equal all have a spring
/// \param dashpot times dt, kg
/// \param velocity slip at the start of the step; midpoint rule: with half the change by other forces
/// \param mean_slip Verlet schemes: mean over the drift before, which stretches the spring
/// \param mobility midpoint rule: mean velocity per impulse, 1/kg
/// \param before Verlet schemes: impulse on j in the last step
/// \param yield largest impulse of friction
/// \return the impulse is that on i
template <bool verlet, bool equal, class Lanes>
EQUIDEM_ALWAYS_INLINE Tangent<Lanes> slide(const SpringLanes<Lanes>& law, const Lanes& dashpot, const Lanes& stretch,
                                           const Lanes& velocity, const Lanes& mean_slip, const Lanes& mobility,
                                           const Lanes& before, const Lanes& yield, double dt) {
  Lanes resistance, mean = velocity;
  if constexpr (!verlet) {
    const Lanes rate = law.rate + dashpot;
    resistance = (law.spring * stretch + rate * velocity) * (1 / (1 + mobility * rate));
  } else {
    resistance = law.spring * (stretch + mean_slip * dt) + dashpot * velocity;
  }
  const Bits<Lanes> slides = negative(yield - magnitude(resistance));
  const Lanes friction = equal ? within(resistance, yield) : choose(slides, with_sign(yield, resistance), resistance);
  if constexpr (!verlet) mean = velocity - mobility * friction;
  const Lanes moved = stretch + (verlet ? mean_slip : mean) * dt;
  Lanes end = choose(slides, within(moved, yield * law.slack), moved);
  if constexpr (!equal) end = only(negative(Lanes{} - law.spring), end);
  const Lanes released = law.half_spring * (stretch - end) * (stretch + end);
  if constexpr (!verlet) {
    const Lanes dragged = only(~slides, dashpot * mean);
    return {friction, end, only(slides, friction * mean + released), dragged * mean, slides};
  }
  // half of the kicks before and after the drift, less the energy stored in the spring
  const Lanes loss = 0.5 * mean_slip * (friction - before) + released;
  return {friction, end, only(slides, loss), only(~slides & negative(Lanes{} - dashpot), loss), slides};
}

/// Losses of the tangential law in the drift in which contacts begin, where their first kick does half its work.
template <class Lanes>
struct FirstSlip {
  Lanes slip_loss, dashpot_loss;
};

/// \param drag impulse of the dashpot \param tangential impulse on j
template <class Lanes>
EQUIDEM_ALWAYS_INLINE FirstSlip<Lanes> first_slip_of(const SpringLanes<Lanes>& law, const Tangent<Lanes>& tangent,
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
EQUIDEM_ALWAYS_INLINE void resist(const SpringLanes<Lanes>& law, const Lanes& dashpot, Lanes velocity,
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
  Tangent<Lanes> tangent =
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
