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

#include "equidem/contact/laws/law.hpp"
#include "equidem/core/simd.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/resist.hpp"

namespace equidem::eight {

template <class Lanes>
struct LaneSums {
  /// Losses: normal dashpot, slip, tangential dashpot, rolling. Summed contact by contact, so that pairs apart do not
  /// change the result.
  Row<Lanes> lost{};
  double without_friction = 0;  ///< losses of normal dashpots in loops without friction
  double released = 0;          ///< by contacts that ended
  Lanes deepest{};
  Bits<Lanes> evaluations{}, begun{};
  Row<Lanes> on_images{};  ///< as ImageImpulses, contact by contact, too
};

using simd::add;
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add(const LaneSums<Lanes>& sums, BlockSums& block) {
  double lost[4], on_images[4];
  PairLanes deepest;
  std::int64_t evaluations[lanes_of_pairs], begun[lanes_of_pairs];
  store(sums.lost, lost);
  store(sums.on_images, on_images);
  store(sums.deepest, deepest);
  store(sums.evaluations, evaluations);
  store(sums.begun, begun);
  block.lost.lost_dashpot += lost[0] + sums.without_friction;
  block.lost.lost_slip += lost[1];
  block.lost.lost_tangential_dashpot += lost[2];
  block.lost.lost_rolling += lost[3];
  block.lost.lost_release += sums.released;
  block.on_images += {{on_images[0], on_images[1]}, {on_images[2], on_images[3]}};
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    block.evaluations += evaluations[k];
    block.contacts += begun[k];
    block.deepest = std::max(block.deepest, deepest[k]);
  }
}

/// Constants of the laws of eight contacts.
template <class Lanes>
struct LawLanes {
  Lanes stiffness;  ///< times dt
  Lanes least;      ///< as in PairLaw
  SlidingLaw<Lanes> slip;
};

/// Periods of a cell, and the velocities to images by one of each.
struct CellShifts {
  Periods places, velocities;

  explicit CellShifts(const MovingCell& cell) : places(cell.now) {
    if (cell.deforms) velocities = {cell.gradient * cell.before.a, cell.gradient * cell.before.b};
  }
};

/// The numbers that all contacts of a loop share.
template <class Lanes>
struct LoopNumbers {
  LawLanes<Lanes> law;  ///< where all have the same
  double dt;
  std::int64_t now;  ///< the step that is being made, as ContactGroup::since
  bool record;
  CellShifts shifts;

  explicit LoopNumbers(const GrainSystem& system)
      : dt(system.dt()),
        now(system.step + (system.options.verlet() ? 0 : 1)),
        record(system.contacts.record),
        shifts(system.cell) {
    const PairLaw of = system.contacts.law.value_or(PairLaw{});
    law = {dt * all<Lanes>(of.stiffness), all<Lanes>(of.least),
           sliding_law(all<Lanes>(of.friction), all<Lanes>(of.tangential_stiffness),
                       all<Lanes>(1 / of.tangential_stiffness), dt)};
  }
};

/// \param laws not read where all have the same
template <ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE LawLanes<Lanes> law_of(const LoopNumbers<Lanes>& numbers, const PairLaws* laws) {
  if constexpr (kind.equal) return numbers.law;
  return {numbers.dt * load<Lanes>(laws->stiffness), load<Lanes>(laws->least),
          sliding_law(load<Lanes>(laws->friction), load<Lanes>(laws->tangential_stiffness), numbers.dt)};
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
  RollingMemory<Lanes> rolling;
};

/// Energies that a contact loses in a step, J: by its normal dashpot and by slip.
template <class Lanes>
struct ContactLosses : SpringLosses<Lanes> {
  Lanes normal;
};

/// \param dashpot normal, times dt, kg; hertz: kg/m^(1/4)
/// \param slip_dashpot tangential, times dt, kg
/// \param[in,out] effects used where the kind has some
/// \param[in,out] memory of the contacts
/// \param[out] losses in place: compilers copy a struct of lanes piece by piece
template <class Law, ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE void respond(const LawLanes<Lanes>& law, const Lanes& dashpot, const Lanes& slip_dashpot,
                                   const ContactMotion<Lanes>& motion, const ContactChanges<Lanes>& near, double dt,
                                   EffectLanes<Lanes>& effects, ContactMemory<Lanes>& memory,
                                   ContactLosses<Lanes>& losses) {
  losses.released = Lanes{};
  ContactChanges<Lanes> at = near;
  Lanes before = memory.impulse;  // of spring and dashpot
  if constexpr (kind.cohesion) {
    at = pressing<kind>(near, motion);
    before += only(near.alive, effects.cohesion.attraction);
  }
  const Bits<Lanes>& touch = at.touch;
  const Lanes deep = only(touch, motion.overlap);
  const Lanes elastic = Law::spring(law.stiffness, deep), drag = Law::dashpot(dashpot, deep) * motion.closing;
  const Lanes impulse = only(touch, larger(law.least, elastic + drag));  // in this order a NaN persists
  Lanes sum = impulse;
  if constexpr (kind.cohesion) sum -= only(near.touch, effects.cohesion.attraction);
  if constexpr (kind.verlet) {
    const Lanes elastic_before = Law::spring(law.stiffness, motion.overlap_before);
    losses.normal =
        only(touch & at.alive, 0.5 * motion.mean_closing * ((before - elastic_before) + (impulse - elastic)));
    if (at.any) [[unlikely]]
      losses.normal += normal_loss_at_ends<Law>(at.begun, at.ended, motion.mean_closing, impulse - elastic, before,
                                                elastic_before, motion.overlap_before, dt);
  } else {
    const Lanes mean_closing = motion.half_mobility * (memory.impulse - sum) + motion.middle_closing;
    losses.normal = (impulse - elastic) * mean_closing;
    if constexpr (!kind.bounded) losses.normal = only(touch, losses.normal);
  }
  memory.impulse = sum;
  if constexpr (kind.friction) {
    resist<typename Law::Tangential, kind>(law.slip, slip_dashpot, motion.slip, motion.mean_slip, motion.mobility,
                                           impulse, at, dt, memory.tangential, memory.stretch, losses);
    if constexpr (kind.rolling) losses.released += roll<kind>(effects.rolling, impulse, at, dt, memory.rolling);
    if constexpr (kind.cohesion) losses.released += lost_at_range<kind>(effects.cohesion, motion, near, dt);
  } else {
    memory.tangential = Lanes{};  // the friction of an earlier stage may have left one
  }
}

/// Add the losses of eight contacts.
/// \param rolling where the kind has it
template <ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE void add_losses(const ContactLosses<Lanes>& losses, const Lanes& rolling, bool changes,
                                      LaneSums<Lanes>& sums) {
  if constexpr (kind.friction) {
    if (changes || kind.cohesion) [[unlikely]]
      sums.released = add_up(losses.released, sums.released);
    Row<Lanes> row[8];
    rows_of(losses.normal, losses.slip, losses.dashpot, kind.rolling ? rolling : Lanes{}, row);
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
    store(choose(at.begun, all<Bits<Lanes>>(now), choose(at.ended, all<Bits<Lanes>>(ContactGroup::apart), before)),
          since);
    sums.begun -= at.begun;
  }
  sums.evaluations -= touch;
  return true;
}

/// From the second bodies to their images.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Vectors<Lanes> shift_of(const Periods& periods, const PairImages& images) {
  const auto a = load<Lanes>(images.a), b = load<Lanes>(images.b);
  return {a * periods.a.x + b * periods.b.x, a * periods.a.y + b * periods.b.y};
}

/// Add impulses (x, y) on images.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add_on_images(const Lanes& x, const Lanes& y, const PairImages& images,
                                         LaneSums<Lanes>& sums) {
  const auto a = load<Lanes>(images.a), b = load<Lanes>(images.b);
  Row<Lanes> rows[lanes_of_pairs];
  rows_of(x * a, y * a, x * b, y * b, rows);
  for (const Row<Lanes>& row : rows) sums.on_images += row;
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
