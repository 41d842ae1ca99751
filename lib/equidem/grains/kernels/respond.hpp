// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The response of contacts in a step of a force law: from their geometry and motion to impulse, losses and new state.
///
/// Written once for discs, parts of bodies and walls, for both schemes, and for one contact (Number = double) or eight.
///
/// Semi-implicit Euler: the tangential spring follows the midpoint rule, losses are those at the mean velocity of the
/// step, of which the part of this contact is known and that of all others is taken from the step before.
///
/// Verlet schemes: the kick J of an instant does work half with the velocity of the drift before it and half with that
/// of the drift after it. The loss of a contact in a drift is 0.5 (J_before + J_now) times its speed, less the energy
/// stored in its springs. A contact that begins or ends within a drift has one of the two kicks: the ledger is of the
/// first order of the step there.
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

using simd::add;
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
                            elastic_before * deep_before / ((1 + Law::facts.spring_power) * dt));
  return only(begun, 0.5 * mean_closing * viscous) + only(ended, last);
}

/// Compile-time properties of a response.
struct ResponseKind {
  bool friction = false;
  bool verlet = false;
  bool equal = false;    ///< one law for all contacts, with a tangential spring where there is friction
  bool bounded = false;  ///< numbers of contacts apart are finite, and their law is equal: they give zeros unmasked
};

/// What the response needs of the geometry and the motion of contacts. Speeds are those of j or of the wall relative to
/// i, at the contact point: closing ones positive, slips along perpendicular(normal).
template <class Lanes>
struct ContactMotion {
  Lanes overlap;
  Lanes closing;  ///< at the instant
  // semi-implicit Euler: with half of the change of velocity in the last step
  Lanes middle_closing;
  Lanes half_mobility;  ///< mean closing speed per normal impulse, 1/kg
  // Verlet schemes: over the drift before the instant
  Lanes mean_closing;
  Lanes overlap_before;  ///< at its start, >= 0
  // with friction
  Lanes slip;       ///< Euler: with half of the change in the last step; Verlet: at the instant
  Lanes mobility;   ///< Euler: mean slip per tangential impulse, 1/kg
  Lanes mean_slip;  ///< Verlet: over the drift
};

/// What a contact carries from step to step.
template <class Lanes>
struct ContactMemory {
  Lanes impulse;     ///< normal, N s
  Lanes tangential;  ///< on j, N s
  Lanes stretch;     ///< of the tangential spring, m
};

/// Which contacts act, begin and end in a step.
template <class Lanes>
struct ContactChanges {
  Bits<Lanes> touch, alive, begun, ended;
  bool any;    ///< some contact begins or ends
  bool first;  ///< first step of the simulation: where the contacts were before is not known
};

template <class Lanes>
struct ContactLosses {
  Lanes normal, slip, dashpot, released;  ///< J; the last is what the tangential springs of ended contacts held
};

/// \param dashpot normal, times dt, kg; hertz: kg/m^(1/4)
/// \param slip_dashpot tangential, times dt, kg
/// \param[in,out] memory of the contacts
///
/// Other torques and forces of a contact (rolling resistance, cohesion) belong here: a member of LawLanes for their
/// constants, one of ContactMemory for their state, one of ContactLosses for the ledger.
template <class Law, ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE ContactLosses<Lanes> respond(const LawLanes<Lanes>& law, const Lanes& dashpot,
                                                   const Lanes& slip_dashpot, const ContactMotion<Lanes>& motion,
                                                   const ContactChanges<Lanes>& at, double dt,
                                                   ContactMemory<Lanes>& memory) {
  const Lanes zero{};
  const Bits<Lanes>& touch = at.touch;
  const Lanes deep = only(touch, motion.overlap);
  const Lanes elastic = Law::spring(law.stiffness, deep), drag = Law::dashpot(dashpot, deep) * motion.closing;
  const Lanes impulse = only(touch, larger(law.least, elastic + drag));  // in this order a NaN persists
  ContactLosses<Lanes> losses{};
  if constexpr (kind.verlet) {
    const Lanes elastic_before = Law::spring(law.stiffness, motion.overlap_before);
    losses.normal =
        only(touch & at.alive, 0.5 * motion.mean_closing * ((memory.impulse - elastic_before) + (impulse - elastic)));
    if (at.any) [[unlikely]]
      losses.normal += normal_loss_at_ends<Law>(at.begun, at.ended, motion.mean_closing, impulse - elastic,
                                                memory.impulse, elastic_before, motion.overlap_before, dt);
  } else {
    const Lanes mean_closing = motion.half_mobility * (memory.impulse - impulse) + motion.middle_closing;
    losses.normal = (impulse - elastic) * mean_closing;
    if constexpr (!kind.bounded) losses.normal = only(touch, losses.normal);
  }
  memory.impulse = impulse;
  if constexpr (kind.friction) {
    Lanes stretch = memory.stretch, velocity = motion.slip;
    if constexpr (kind.verlet) {
      if (at.any || at.first)
          [[unlikely]]  // its place before is not known: the slip at the instant is that of the step
        stretch += only(at.first ? touch : at.begun, (velocity - motion.mean_slip) * dt);
    } else {
      velocity -= motion.mobility * memory.tangential;  // without this contact's own part in it
    }
    const Lanes yield = law.friction * larger(impulse, zero);
    Tangent<Lanes> tangent = slide<kind.verlet, kind.equal>(law, slip_dashpot, stretch, velocity, motion.mean_slip,
                                                            motion.mobility, memory.tangential, yield, dt);
    if constexpr (!kind.bounded) {
      tangent.impulse = only(touch, tangent.impulse);
      tangent.stretch = only(touch, tangent.stretch);
    }
    const Lanes tangential = -tangent.impulse;
    if (at.any || !kind.bounded) {
      const Bits<Lanes> lasting = kind.verlet ? touch & at.alive : touch;
      tangent.slip_loss = only(lasting, tangent.slip_loss);
      tangent.dashpot_loss = only(lasting, tangent.dashpot_loss);
    }
    if (at.any) [[unlikely]] {
      losses.released = law.half_spring * stretch * stretch;
      if constexpr (kind.verlet) {
        const FirstSlip<Lanes> first =
            first_slip_of(law, tangent, slip_dashpot * velocity, tangential, motion.mean_slip, at.begun);
        tangent.slip_loss += first.slip_loss;
        tangent.dashpot_loss += first.dashpot_loss;
        losses.released -= 0.5 * memory.tangential * motion.mean_slip;
      }
      losses.released = only(at.ended, losses.released);
    }
    losses.slip = tangent.slip_loss;
    losses.dashpot = tangent.dashpot_loss;
    memory.tangential = tangential;
    memory.stretch = tangent.stretch;
  } else {
    memory.tangential = zero;  // the friction of an earlier stage may have left one
  }
  return losses;
}

/// Add the losses of eight contacts.
template <ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE void add_losses(const ContactLosses<Lanes>& losses, bool changes, LaneSums<Lanes>& sums) {
  if constexpr (kind.friction) {
    if (changes) [[unlikely]]
      sums.released = add_up(losses.released, sums.released);
    Row<Lanes> row[8];
    rows_of(losses.normal, losses.slip, losses.dashpot, Lanes{}, row);
    for (const Row<Lanes>& lost : row) sums.lost += lost;
  } else {
    sums.without_friction = add_up(losses.normal, sums.without_friction);
  }
}

/// Set which contacts begin and end, and count them.
/// \param now the step that is being made, as in `since`
/// \param[in,out] since first step of each contact
/// \return whether any contact acts, begins or ends
template <class Lanes>
EQUIDEM_ALWAYS_INLINE bool begin_and_end(const Bits<Lanes>& touch, std::int64_t now, std::int64_t* since,
                                         ContactChanges<Lanes>& at, LaneSums<Lanes>& sums) {
  const auto before = load<Bits<Lanes>>(since);
  at.touch = touch;
  at.alive = ~(before >> 63);
  const long long which = bits_of_all((touch & 1) | ((touch ^ at.alive) & 2));
  at.any = (which & 2) != 0;
  at.first = now == 0;
  if (which == 0) return false;
  at.begun = touch & ~at.alive;
  at.ended = at.alive & ~touch;
  if (at.any) {
    store(choose(at.begun, all<Bits<Lanes>>(now), choose(at.ended, all<Bits<Lanes>>(PairGroup::apart), before)), since);
    sums.begun -= at.begun;
  }
  sums.evaluations -= touch;
  return true;
}

/// Where the impulses of a block go.
struct Receivers {
  BodyImpulse* impulses = nullptr;
  std::int32_t end = 0;                  ///< of the bodies of the block
  const std::int32_t* bodies = nullptr;  ///< of the parts; null: contacts are of whole bodies

  EQUIDEM_ALWAYS_INLINE std::int32_t of(std::int32_t number) const {
    return bodies == nullptr ? number : bodies[number];
  }
};

/// Add the impulses of eight contacts to their bodies: on_j to j, the opposite of on_i to i.
/// \tparam outward some bodies are behind the block
/// \param[in,out] next place for the impulse on such a body
template <bool outward, class Numbers, class OnJ>
EQUIDEM_ALWAYS_INLINE void scatter(const std::int32_t (&i)[8], const std::int32_t (&j)[8], const Receivers& to,
                                   BodyImpulse*& next, const Numbers (&on_i)[8], const OnJ& on_j) {
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    subtract(&to.impulses[to.of(i[k])], on_i[k]);
    const std::int32_t body = to.of(j[k]);
    if (outward && body >= to.end) {
      store(Numbers(on_j(k)), next++);
    } else {
      add(&to.impulses[body], Numbers(on_j(k)));
    }
  }
}
/// Likewise of contacts apart.
template <bool outward>
EQUIDEM_ALWAYS_INLINE void give_nothing(const std::int32_t (&j)[8], const Receivers& to, BodyImpulse*& next) {
  for (std::size_t k = 0; outward && k < lanes_of_pairs; ++k) {
    if (to.of(j[k]) >= to.end) *next++ = {};
  }
}

}  // namespace equidem::eight
