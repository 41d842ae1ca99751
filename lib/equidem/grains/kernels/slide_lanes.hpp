// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The tangential law of eight contacts at once.
#pragma once

#include "equidem/grains/kernels/pair_lanes.hpp"

namespace equidem::eight {

struct LawLanes {
  Lanes stiffness, least, friction, tangential_stiffness, beyond_cap, tangential_compliance;
};

struct Tangent {
  Lanes force, stretch, slip_loss, dashpot_loss;
  Choice slides;
};

/// sliding_step (verlet) and sliding_step_midpoint for contacts that have a spring, or no friction.
/// \tparam equal the dashpot is inactive while contacts slide, and all have a spring
/// \param velocity slip at the start of the step; midpoint rule: with half the change by other forces
/// \param mean_slip Verlet schemes: mean over the drift before, to count losses
/// \param mobility midpoint rule: mean velocity per mean force
/// \param before Verlet schemes: impulse on j in the last step
template <bool verlet, bool equal>
EQUIDEM_ALWAYS_INLINE Tangent slide(const LawLanes& law, const Lanes& dashpot, const Lanes& stretch,
                                    const Lanes& velocity, const Lanes& mean_slip, const Lanes& mobility,
                                    const Lanes& before, const Lanes& yield, double dt) {
  const Lanes spring = law.tangential_stiffness;
  Lanes resistance, mean = velocity;
  if constexpr (!verlet) {
    const Lanes rate = spring * (dt / 2) + dashpot;
    resistance = (spring * stretch + rate * velocity) * (1 / (1 + mobility * rate));
  } else {
    resistance = spring * (stretch + velocity * dt) + dashpot * velocity;
  }
  Lanes capped = resistance;
  if constexpr (!equal) {
    if constexpr (!verlet) mean = velocity - mobility * resistance;
    capped -= law.beyond_cap * dashpot * mean;
  }
  const Choice slides = negative(yield - magnitude(capped));
  const Lanes friction = choose(slides, with_sign(yield, capped), resistance);
  Lanes drag{}, force = friction;
  if constexpr (!verlet) mean = velocity - mobility * friction;
  if constexpr (!equal) {
    if constexpr (!verlet) {
      mean = choose(slides, mean / (1 + law.beyond_cap * mobility * dashpot), mean);
    }
    drag = only(slides, law.beyond_cap * dashpot * mean);
    force += drag;
  }
  const Lanes moved = stretch + mean * dt;
  const Lanes largest = yield * law.tangential_compliance;
  Lanes end = choose(slides, smaller(larger(moved, -largest), largest), moved);
  if constexpr (!equal) end = spring > 0 ? end : Lanes{};
  const Lanes released = 0.5 * spring * (stretch - end) * (stretch + end);
  if constexpr (!verlet) {
    const Lanes dragged = choose(slides, drag, dashpot * mean);
    return {force, end, only(slides, friction * mean * dt + released), dragged * mean * dt, slides};
  }
  // half of the kicks before and after the drift, less the energy stored in the spring
  const Lanes loss = 0.5 * mean_slip * (force * dt - before) + released;
  const Lanes dragged = drag * mean_slip * dt;
  return {force, end, only(slides, loss - dragged), choose(slides, dragged, only(negative(-dashpot), loss)), slides};
}

/// Tangential law of contacts without a spring: the force that stops the slip within the step, limited by friction.
/// \param velocity,mobility as for the midpoint rule, in every scheme
template <bool verlet>
EQUIDEM_ALWAYS_INLINE Tangent slide_without_spring(const LawLanes& law, const Lanes& velocity, const Lanes& mean_slip,
                                                   const Lanes& mobility, const Lanes& before, const Lanes& yield,
                                                   double dt) {
  const Lanes force = smaller(larger(velocity / (2 * mobility), -yield), yield);
  const Lanes loss = verlet ? 0.5 * mean_slip * (force * dt - before) : force * (velocity - mobility * force) * dt;
  return {force, Lanes{}, loss, Lanes{}, negative(-law.friction)};
}

}  // namespace equidem::eight
