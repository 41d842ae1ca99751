// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The tangential law of eight contacts at once, in impulses of a step.
#pragma once

#include "equidem/grains/kernels/pair_lanes.hpp"

namespace equidem::eight {

/// Constants of the laws of eight contacts.
template <class Lanes>
struct LawLanes {
  Lanes stiffness;    ///< times dt
  Lanes least;        ///< as in PairLaw
  Lanes friction;     ///< mu
  Lanes half_spring;  ///< k_T/2, N/m
  Lanes spring;       ///< k_T dt, N s/m
  Lanes rate;         ///< k_T dt²/2, kg
  Lanes slack;        ///< 1/(k_T dt), m/(N s); finite without a spring, too
  Lanes beyond_cap;   ///< as in PairLaw
};

/// \param tangential k_T, N/m
/// \param compliance 1/k_T, m/N
template <class Lanes>
EQUIDEM_ALWAYS_INLINE LawLanes<Lanes> law_lanes(const Lanes& stiffness, const Lanes& least, const Lanes& friction,
                                                const Lanes& tangential, const Lanes& compliance,
                                                const Lanes& beyond_cap, double dt) {
  return {dt * stiffness,        least,     friction, 0.5 * tangential, dt * tangential, (0.5 * dt * dt) * tangential,
          (1 / dt) * compliance, beyond_cap};
}

template <class Lanes>
struct Tangent {
  Lanes impulse, stretch, slip_loss, dashpot_loss;
  Bits<Lanes> slides;
};

/// sliding_step (verlet) and sliding_step_midpoint for contacts that have a spring, or no friction.
/// \tparam equal the dashpot is inactive while contacts slide, and all have a spring
/// \param dashpot times dt, kg
/// \param velocity slip at the start of the step; midpoint rule: with half the change by other forces
/// \param mean_slip Verlet schemes: mean over the drift before, which stretches the spring
/// \param mobility midpoint rule: mean velocity per impulse, 1/kg
/// \param before Verlet schemes: impulse on j in the last step
/// \param yield largest impulse of friction
/// \return the impulse is that on i
template <bool verlet, bool equal, class Lanes>
EQUIDEM_ALWAYS_INLINE Tangent<Lanes> slide(const LawLanes<Lanes>& law, const Lanes& dashpot, const Lanes& stretch,
                                           const Lanes& velocity, const Lanes& mean_slip, const Lanes& mobility,
                                           const Lanes& before, const Lanes& yield, double dt) {
  Lanes resistance, mean = velocity;
  if constexpr (!verlet) {
    const Lanes rate = law.rate + dashpot;
    resistance = (law.spring * stretch + rate * velocity) * (1 / (1 + mobility * rate));
  } else {
    resistance = law.spring * (stretch + mean_slip * dt) + dashpot * velocity;
  }
  Lanes capped = resistance;
  if constexpr (!equal) {
    if constexpr (!verlet) mean = velocity - mobility * resistance;
    capped -= law.beyond_cap * dashpot * mean;
  }
  const Bits<Lanes> slides = negative(yield - magnitude(capped));
  const Lanes friction = equal ? within(resistance, yield) : choose(slides, with_sign(yield, capped), resistance);
  Lanes drag{}, impulse = friction;
  if constexpr (!verlet) mean = velocity - mobility * friction;
  if constexpr (!equal) {
    if constexpr (!verlet) {
      mean = choose(slides, mean / (1 + law.beyond_cap * mobility * dashpot), mean);
    }
    drag = only(slides, law.beyond_cap * dashpot * mean);
    impulse += drag;
  }
  const Lanes moved = stretch + (verlet ? mean_slip : mean) * dt;
  Lanes end = choose(slides, within(moved, yield * law.slack), moved);
  if constexpr (!equal) end = only(negative(Lanes{} - law.spring), end);
  const Lanes released = law.half_spring * (stretch - end) * (stretch + end);
  if constexpr (!verlet) {
    const Lanes dragged = equal ? only(~slides, dashpot * mean) : choose(slides, drag, dashpot * mean);
    return {impulse, end, only(slides, friction * mean + released), dragged * mean, slides};
  }
  // half of the kicks before and after the drift, less the energy stored in the spring
  const Lanes loss = 0.5 * mean_slip * (impulse - before) + released;
  const Lanes dragged = drag * mean_slip;
  return {impulse, end, only(slides, loss - dragged), choose(slides, dragged, only(negative(Lanes{} - dashpot), loss)),
          slides};
}

/// Tangential law of contacts without a spring: the impulse that stops the slip within the step, limited by friction.
/// \param velocity,mobility as for the midpoint rule, in every scheme
template <bool verlet, class Lanes>
EQUIDEM_ALWAYS_INLINE Tangent<Lanes> slide_without_spring(const LawLanes<Lanes>& law, const Lanes& velocity,
                                                          const Lanes& mean_slip, const Lanes& mobility,
                                                          const Lanes& before, const Lanes& yield) {
  const Lanes impulse = within(velocity / (2 * mobility), yield);
  const Lanes loss = verlet ? 0.5 * mean_slip * (impulse - before) : impulse * (velocity - mobility * impulse);
  return {impulse, Lanes{}, loss, Lanes{}, negative(Lanes{} - law.friction)};
}

}  // namespace equidem::eight
