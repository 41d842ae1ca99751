// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/core/simd.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/respond.hpp"

namespace equidem {
namespace {

using namespace eight;

/// So many go through each part of the work before the next begins: a processor sees several of them at a time, and
/// does not wait for the roots and quotients of one.
constexpr std::size_t groups_at_once = 8;

/// Relative positions and velocities of eight pairs: from i to j, along the normal and across it.
template <class Lanes>
struct DiscGeometry {
  Lanes square, distance, share, overlap, nx, ny, opening;
  Lanes inverse, along, rims;  ///< Verlet schemes; 1/distance
  /// With half of what the last step did; of the slip all but the rims.
  Lanes middle_opening, middle_slip, middle_rims;
};

/// Results of the contacts of a group.
template <class Lanes>
struct Outcome {
  Lanes px, py, rim;  ///< impulse on j
  bool any;
  // with friction
  ContactLosses<Lanes> losses;
  bool changes;
  Lanes torque, lost_rolling;  ///< with rolling
};

/// \tparam cell pairs are with images
template <ResponseKind kind, bool cell, class Lanes>
EQUIDEM_ALWAYS_INLINE void measure(const PairBody* bodies, const ContactGroup& group, const PairImages* images,
                                   const CellShifts& shifts, DiscGeometry<Lanes>& found) {
  // differences j - i, sums of the speeds of the rims
  constexpr long long minus = std::numeric_limits<long long>::min();
  alignas(64) constexpr long long difference[lanes_of_pairs] = {minus, minus, minus, minus, minus, minus, 0, 0};
  const auto turned = load<Bits<Lanes>>(difference);
  Lanes m[lanes_of_pairs];
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    const auto i = load<Lanes>(&bodies[group.i[k]].position.x);
    m[k] = load<Lanes>(&bodies[group.j[k]].position.x) + as<Lanes>(bits_of(i) ^ turned);
  }
  transpose(m);
  if constexpr (cell) {
    const Vectors<Lanes> shift = shift_of<Lanes>(shifts.places, *images);
    const Vectors<Lanes> velocity = shift_of<Lanes>(shifts.velocities, *images);
    m[0] += shift.x;
    m[1] += shift.y;
    m[2] += velocity.x;
    m[3] += velocity.y;
  }
  Lanes& bx = m[0];
  const Lanes &by = m[1], &u = m[2], &v = m[3];
  const Lanes square = square_of_branch(bx, by);
  const Lanes distance = square_root(square);
  const auto reach = load<Lanes>(group.reach);
  const Lanes quotient = 1 / (distance * reach);
  const Lanes inverse = reach * quotient;
  const Lanes nx = bx * inverse, ny = by * inverse;
  found.square = square;
  found.overlap = reach - distance;
  found.nx = nx;
  found.ny = ny;
  found.opening = u * nx + v * ny;
  if constexpr (kind.friction) found.share = square * quotient;
  if constexpr (kind.verlet) {
    found.distance = distance;
    found.inverse = inverse;
    found.along = v * nx - u * ny;
    if constexpr (kind.friction) found.rims = m[7];
  } else {
    found.middle_opening = m[4] * nx + m[5] * ny;
  }
  if constexpr (kind.friction && !kind.verlet) {
    found.middle_slip = m[5] * nx - m[4] * ny;
    found.middle_rims = m[6];
  }
}

/// Mean of the slip at both ends of the drift. At its start the distance was q times the present one, what the
/// velocities of the centres give 1/q, and what the rims give q times theirs. 1/q by a step of Newton's from its
/// expansion: to the sixth order, without a root or quotient.
/// \param mean_closing q = 1 + mean_closing dt/distance, but for the third order
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes mean_slip_of(const DiscGeometry<Lanes>& geometry, const Lanes& rims, const Lanes& now,
                                         const Lanes& mean_closing, double dt) {
  const Lanes part = dt * geometry.inverse, opened = part * geometry.opening, closed = part * mean_closing;
  const Lanes square = 1 + (closed + closed + opened * opened), near = 1 - closed * (1 - closed);
  const Lanes inverse = near * (1.5 - 0.5 * (square * near * near));
  return 0.5 * (now + (geometry.along - rims * square) * inverse);
}

/// Their motion at the contact points; over the drift in Verlet schemes, in which the normal turns.
template <ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE ContactMotion<Lanes> motion_of(const DiscGeometry<Lanes>& geometry, const ContactGroup& group,
                                                     const PairSlips* slips, double dt) {
  ContactMotion<Lanes> motion;
  motion.overlap = geometry.overlap;
  motion.closing = -geometry.opening;
  if constexpr (kind.verlet) {
    motion.mean_closing = (0.5 * dt) * geometry.inverse * geometry.along * geometry.along - geometry.opening;
    motion.overlap_before = larger(geometry.overlap - motion.mean_closing * dt, Lanes{});
    if constexpr (kind.friction) {
      const Lanes rims = geometry.share * geometry.rims;
      motion.slip = geometry.along - rims;
      motion.mean_slip = mean_slip_of(geometry, rims, motion.slip, motion.mean_closing, dt);
    }
  } else {
    motion.half_mobility = load<Lanes>(group.half_mobility);
    motion.middle_closing = -geometry.middle_opening;
    if constexpr (kind.friction) {
      motion.mobility = motion.half_mobility + load<Lanes>(slips->half_turning) * geometry.square;
      motion.slip = geometry.middle_slip - geometry.share * geometry.middle_rims;
    }
  }
  return motion;
}

/// R (spin of j - spin of i), by the speeds of the rims.
template <ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes rolling_velocity(const PairBody* bodies, const ContactGroup& group,
                                             const ContactEffects& effects) {
  PairLanes rim_i, rim_j;
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    const PairBody &i = bodies[group.i[k]], &j = bodies[group.j[k]];
    rim_i[k] = kind.verlet ? i.rim_speed : i.middle_rim_speed;
    rim_j[k] = kind.verlet ? j.rim_speed : j.middle_rim_speed;
  }
  const Lanes share = load<Lanes>(effects.share);
  return share * load<Lanes>(rim_j) - (1 - share) * load<Lanes>(rim_i);
}

template <class Law, ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE void respond_discs(const LoopNumbers<Lanes>& numbers, const PairBody* bodies,
                                         const DiscGeometry<Lanes>& geometry, ContactGroup& group, PairSlips* slips,
                                         const PairLaws* laws, ContactEffects* effects, PairRecords* records,
                                         LaneSums<Lanes>& sums, Outcome<Lanes>& outcome) {
  ContactChanges<Lanes> at;
  EffectLanes<Lanes> effect_lanes;
  Bits<Lanes> touch;
  if constexpr (kind.cohesion) {
    effect_lanes.cohesion = cohesion_lanes<Lanes>(*effects);
    touch = negative(Lanes{} - (geometry.overlap + effect_lanes.cohesion.range));
  } else {
    touch = negative(Lanes{} - geometry.overlap);
  }
  outcome.any = begin_and_end(touch, numbers.now, group.since, at, sums);
  if (!outcome.any) return;
  const ContactMotion<Lanes> motion = motion_of<kind>(geometry, group, slips, numbers.dt);
  sums.deepest = larger(only(at.touch, motion.overlap), sums.deepest);
  ContactMemory<Lanes> memory;
  Lanes slip_dashpot;
  memory.impulse = load<Lanes>(group.impulse);
  if constexpr (kind.friction) {
    memory.tangential = load<Lanes>(slips->impulse);
    memory.stretch = load<Lanes>(slips->stretch);
    slip_dashpot = load<Lanes>(slips->dashpot);
  }
  if constexpr (kind.rolling) {
    effect_lanes.rolling = rolling_lanes(*effects, rolling_velocity<kind, Lanes>(bodies, group, *effects), numbers.dt);
    memory.rolling = rolling_memory<Lanes>(*effects);
  }
  ContactLosses<Lanes> added_here{};
  ContactLosses<Lanes>& losses = kind.friction ? outcome.losses : added_here;
  respond<Law, kind>(law_of<kind>(numbers, laws), load<Lanes>(group.dashpot), slip_dashpot, motion, at, numbers.dt,
                     effect_lanes, memory, losses);
  outcome.changes = at.any;
  if constexpr (!kind.friction) add_losses<kind>(losses, Lanes{}, at.any, sums);
  store(memory.impulse, group.impulse);
  outcome.px = memory.impulse * geometry.nx;
  outcome.py = memory.impulse * geometry.ny;
  if constexpr (kind.friction) {
    store(memory.tangential, slips->impulse);
    store(memory.stretch, slips->stretch);
    outcome.px -= memory.tangential * geometry.ny;
    outcome.py += memory.tangential * geometry.nx;
    outcome.rim = geometry.share * memory.tangential;
  }
  if constexpr (kind.rolling) {
    store(memory.rolling, *effects);
    outcome.lost_rolling = effect_lanes.rolling.lost;
    outcome.torque = load<Lanes>(effects->lever) * memory.rolling.impulse;
  }
  if (numbers.record) {
    store(geometry.overlap, records->overlap);
    store(motion.closing, records->closing);
    store(geometry.nx, records->normal_x);
    store(geometry.ny, records->normal_y);
  }
}

/// \tparam outward some bodies are behind the block
template <ResponseKind kind, bool outward, class Lanes>
EQUIDEM_ALWAYS_INLINE void give(const ContactGroup& group, const Outcome<Lanes>& outcome, const Receivers& to,
                                BodyImpulse*& next, LaneSums<Lanes>& sums) {
  if (!outcome.any) return give_nothing<outward>(group.j, to, next);
  if constexpr (kind.friction) add_losses<kind>(outcome.losses, outcome.lost_rolling, outcome.changes, sums);
  Row<Lanes> on_i[lanes_of_pairs];
  rows_of(outcome.px, outcome.py, kind.rolling ? outcome.torque : Lanes{}, kind.friction ? outcome.rim : Lanes{}, on_i);
  // the tangential impulse turns both bodies the same way round, and its lever is the radius
  alignas(32) constexpr long long rim[4] = {0, 0, 0, std::numeric_limits<long long>::min()};
  const auto turned = load<Bits<Row<Lanes>>>(rim);
  scatter<outward>(group.i, group.j, to, next, on_i,
                   [&](std::size_t k) { return kind.friction ? as<Row<Lanes>>(bits_of(on_i[k]) ^ turned) : on_i[k]; });
}

/// \tparam cell pairs are with images
template <class Law, ResponseKind kind, bool cell>
struct CollidePairs {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, NearList& list, std::size_t block);
};

template <class Law, ResponseKind kind, bool cell>
template <class Lanes>
void CollidePairs<Law, kind, cell>::run(GrainSystem& system, NearList& list, std::size_t block) {
  const LoopNumbers<Lanes> numbers(system);
  list.records.used = numbers.record;
  list.records.resize(numbers.record ? list.groups.size() : 0);
  LaneSums<Lanes> sums;
  const PairBody* bodies = system.contacts.pairs.bodies.data();
  const Receivers to{system.bodies.impulses.data(), static_cast<std::int32_t>(system.bodies.blocks.end(block)),
                     nullptr};
  BodyImpulse* outward = list.outward.impulses.data();
  DiscGeometry<Lanes> geometry[groups_at_once];
  Outcome<Lanes> outcome[groups_at_once];
  const std::size_t count = list.groups.size();
  ContactGroup* groups = list.groups.data();
  PairSlips* slips = list.slips.data();
  const PairLaws* laws = list.laws.data();
  ContactEffects* effects = list.effects.data();
  PairRecords* records = list.records.data();
  const PairImages* images = list.images.data();
  for (std::size_t first = 0; first < count; first += groups_at_once) {
    const std::size_t here = std::min(groups_at_once, count - first);
    for (std::size_t g = 0; g < here; ++g)
      measure<kind, cell>(bodies, groups[first + g], cell ? images + (first + g) : nullptr, numbers.shifts,
                          geometry[g]);
    for (std::size_t g = 0; g < here; ++g) {
      respond_discs<Law, kind>(numbers, bodies, geometry[g], groups[first + g],
                               kind.friction ? slips + (first + g) : nullptr, kind.equal ? nullptr : laws + (first + g),
                               effects_at<kind>(effects, first + g), numbers.record ? records + (first + g) : nullptr,
                               sums, outcome[g]);
    }
    if (first + here <= list.first_outward) {
      for (std::size_t g = 0; g < here; ++g) give<kind, false>(groups[first + g], outcome[g], to, outward, sums);
    } else {
      for (std::size_t g = 0; g < here; ++g) give<kind, true>(groups[first + g], outcome[g], to, outward, sums);
    }
    for (std::size_t g = 0; cell && g < here; ++g)
      if (outcome[g].any) add_on_images(outcome[g].px, outcome[g].py, images[first + g], sums);
  }
  add(sums, system.bodies.sums[block]);
}

template <class Law, ResponseKind kind>
NearLists::Loop choose_pair_loop(bool cell) {
  return cell ? by_vector_width<CollidePairs<Law, kind, true>, GrainSystem&, NearList&, std::size_t>()
              : by_vector_width<CollidePairs<Law, kind, false>, GrainSystem&, NearList&, std::size_t>();
}

template <class Law, bool equal>
NearLists::Loop choose_pair_loop(const GrainSystem& system) {
  const bool cell = system.cell.active;
  if constexpr (!equal) {
    if (system.has_effects())
      return system.options.verlet() ? choose_pair_loop<Law, with_effects<true>>(cell)
                                     : choose_pair_loop<Law, with_effects<false>>(cell);
  }
  if (system.options.verlet()) {
    return system.friction ? choose_pair_loop<Law, ResponseKind{true, true, equal, equal}>(cell)
                           : choose_pair_loop<Law, ResponseKind{false, true, equal, equal}>(cell);
  }
  return system.friction ? choose_pair_loop<Law, ResponseKind{true, false, equal, equal}>(cell)
                         : choose_pair_loop<Law, ResponseKind{false, false, equal, equal}>(cell);
}

}  // namespace

NearLists::Loop loop_of_discs(const GrainSystem& system) {
  return visit_law(system.options.law, [&]<class Law>(std::type_identity<Law>) -> NearLists::Loop {
    if constexpr (Law::facts.kind == LawKind::force) {
      return system.contacts.law ? choose_pair_loop<Law, true>(system) : choose_pair_loop<Law, false>(system);
    } else {
      return nullptr;
    }
  });
}

}  // namespace equidem
