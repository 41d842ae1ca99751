// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sums over the contacts of a vectorized loop in a step.
///
/// The tangential law of eight contacts at once, in impulses of a step.
#pragma once

#include <algorithm>

#include "equidem/core/simd.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem::eight {

template <class Lanes>
struct LaneSums {
  /// Losses: normal dashpot, slip, tangential dashpot. Summed contact by contact, so that pairs apart do not change the
  /// result.
  Row<Lanes> lost{};
  double without_friction = 0;  ///< losses of normal dashpots in loops without friction
  double released = 0;          ///< by contacts that ended
  Lanes deepest{};
  Bits<Lanes> evaluations{}, begun{};
};

/// Add the losses of eight contacts.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add_losses(const Lanes& normal, const Lanes& slip, const Lanes& dashpot,
                                      LaneSums<Lanes>& sums) {
  Row<Lanes> row[8];
  rows_of(normal, slip, dashpot, Lanes{}, row);
  for (const Row<Lanes>& lost : row) sums.lost += lost;
}
/// Add the losses of eight contacts without friction.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add_losses(const Lanes& normal, LaneSums<Lanes>& sums) {
  sums.without_friction = add_up(normal, sums.without_friction);
}
/// Add the energy that the tangential springs of contacts that ended held.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add_release(const Lanes& energy, LaneSums<Lanes>& sums) {
  sums.released = add_up(energy, sums.released);
}

template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add(const LaneSums<Lanes>& sums, BlockSums& block) {
  double lost[4];
  PairLanes deepest;
  std::int64_t evaluations[lanes_of_pairs], begun[lanes_of_pairs];
  store(sums.lost, lost);
  store(sums.deepest, deepest);
  store(sums.evaluations, evaluations);
  store(sums.begun, begun);
  block.lost.lost_dashpot += lost[0] + sums.without_friction;
  block.lost.lost_slip += lost[1];
  block.lost.lost_tangential_dashpot += lost[2];
  block.lost.lost_release += sums.released;
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    block.evaluations += evaluations[k];
    block.contacts += begun[k];
    block.deepest = std::max(block.deepest, deepest[k]);
  }
}

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
};

/// \param tangential k_T, N/m
/// \param compliance 1/k_T, m/N
template <class Lanes>
EQUIDEM_ALWAYS_INLINE LawLanes<Lanes> law_lanes(const Lanes& stiffness, const Lanes& least, const Lanes& friction,
                                                const Lanes& tangential, const Lanes& compliance, double dt) {
  return {dt * stiffness,       least, friction, 0.5 * tangential, dt * tangential, (0.5 * dt * dt) * tangential,
          (1 / dt) * compliance};
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
EQUIDEM_ALWAYS_INLINE FirstSlip<Lanes> first_slip_of(const LawLanes<Lanes>& law, const Tangent<Lanes>& tangent,
                                                     const Lanes& drag, const Lanes& tangential, const Lanes& mean_slip,
                                                     const Bits<Lanes>& begun) {
  const Lanes stored = law.half_spring * tangent.stretch * tangent.stretch;
  return {only(begun & tangent.slides, -(0.5 * tangential * mean_slip + stored)),
          only(begun & ~tangent.slides, 0.5 * drag * mean_slip)};
}

/// Losses of normal dashpots in the drift in which contacts begin or end, with one kick of the two. Where a dashpot has
/// cut the force before the end it takes what the spring holds, k d^(p + 1)/(p + 1).
/// \param viscous impulse of the dashpot now
template <class Law, class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes normal_loss_at_ends(const Bits<Lanes>& begun, const Bits<Lanes>& ended,
                                                const Lanes& mean_closing, const Lanes& viscous,
                                                const Lanes& impulse_before, const Lanes& elastic_before,
                                                const Lanes& deep_before, double dt) {
  const Bits<Lanes> given = negative(impulse_before) | negative(Lanes{} - impulse_before);
  const Lanes last = choose(given, 0.5 * mean_closing * (impulse_before - elastic_before),
                            elastic_before * deep_before / ((1 + Law::spring_power) * dt));
  return only(begun, 0.5 * mean_closing * viscous) + only(ended, last);
}

}  // namespace equidem::eight
