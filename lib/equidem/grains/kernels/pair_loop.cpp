// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "equidem/contact/laws/visit.hpp"
#include "equidem/core/simd.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/slide_lanes.hpp"

namespace equidem {
namespace {

using namespace eight;

/// So many go through each part of the work before the next begins: a processor sees several of them at a time, and
/// does not wait for the roots and quotients of one.
constexpr std::size_t groups_at_once = 8;

/// Compile-time properties of a loop.
struct PairLoopKind {
  bool friction = false;
  bool equal = false;   ///< one law for all pairs
  bool verlet = false;  ///< friction by the explicit step, else by the midpoint rule
};

template <class Lanes>
struct LoopNumbers {
  LawLanes<Lanes> law;  ///< where equal
  double dt = 0;
  std::int64_t now = 0;  ///< the step that is being made, as PairGroup::since
  bool record = false;
  BlockSums* block = nullptr;
};

template <PairLoopKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE LawLanes<Lanes> law_of(const LoopNumbers<Lanes>& numbers, const PairLaws* laws) {
  if constexpr (kind.equal) {
    return numbers.law;
  } else {
    const Lanes spring = load<Lanes>(laws->tangential_stiffness);
    const Lanes compliance = 1 / choose(negative(Lanes{} - spring), spring, all<Lanes>(1));
    return law_lanes(load<Lanes>(laws->stiffness), load<Lanes>(laws->least), load<Lanes>(laws->friction), spring,
                     compliance, numbers.dt);
  }
}

/// Relative positions and velocities of eight pairs: from i to j, along the normal and across it.
template <class Lanes>
struct Geometry {
  Lanes square, distance, share, overlap, nx, ny, opening;
  Lanes inverse, along, rims;  ///< Verlet schemes; 1/distance
  /// With half of what the last step did; of the slip all but the rims.
  Lanes middle_opening, middle_slip, middle_rims;
};

/// Results of the contacts of a group.
template <class Lanes>
struct Outcome {
  Lanes px, py, rim;  ///< impulse on j
  Lanes normal_loss, slip_loss, dashpot_loss;
  bool any;
};

template <PairLoopKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE void measure(const PairBody* bodies, const PairGroup& group, Geometry<Lanes>& found) {
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
EQUIDEM_ALWAYS_INLINE Lanes mean_slip_of(const Geometry<Lanes>& geometry, const Lanes& rims, const Lanes& now,
                                         const Lanes& mean_closing, double dt) {
  const Lanes part = dt * geometry.inverse, opened = part * geometry.opening, closed = part * mean_closing;
  const Lanes square = 1 + (closed + closed + opened * opened), near = 1 - closed * (1 - closed);
  const Lanes inverse = near * (1.5 - 0.5 * (square * near * near));
  return 0.5 * (now + (geometry.along - rims * square) * inverse);
}

/// A lane apart gives zeros: its impulse and its stretch are zero, and so is the yield of friction.
template <class Law, PairLoopKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE void respond(const LoopNumbers<Lanes>& numbers, const Geometry<Lanes>& geometry, PairGroup& group,
                                   PairSlips* slips, const PairLaws* laws, PairRecords* records, LaneSums<Lanes>& sums,
                                   Outcome<Lanes>& outcome) {
  const double dt = numbers.dt;
  const Lanes &overlap = geometry.overlap, &nx = geometry.nx, &ny = geometry.ny, &opening = geometry.opening;
  const auto since = load<Bits<Lanes>>(group.since);
  const Lanes zero{};
  const Bits<Lanes> touch = negative(zero - overlap), alive = ~(since >> 63);
  const long long which = bits_of_all((touch & 1) | ((touch ^ alive) & 2));
  const bool changes = (which & 2) != 0;
  outcome.any = which != 0;
  if (which == 0) return;
  const Bits<Lanes> begun = touch & ~alive, ended = alive & ~touch;
  if (changes) {
    store(choose(begun, all<Bits<Lanes>>(numbers.now), choose(ended, all<Bits<Lanes>>(PairGroup::apart), since)),
          group.since);
    sums.begun -= begun;
  }
  sums.evaluations -= touch;

  const LawLanes<Lanes> law = law_of<kind>(numbers, laws);
  const auto dashpot = load<Lanes>(group.dashpot), half_mobility = load<Lanes>(group.half_mobility);
  const Lanes deep = only(touch, overlap);
  const Lanes elastic = Law::spring(law.stiffness, deep), drag = Law::dashpot(dashpot, deep) * opening;
  const Lanes impulse = only(touch, larger(law.least, elastic - drag));  // in this order a NaN persists
  const auto impulse_before = load<Lanes>(group.impulse);
  store(impulse, group.impulse);
  Lanes mean_closing, deep_before, elastic_before;
  if constexpr (kind.verlet) {
    // over the drift, in which the normal turns; the dashpot gives half of the kicks before and after it each
    mean_closing = (0.5 * dt) * geometry.inverse * geometry.along * geometry.along - opening;
    deep_before = larger(overlap - mean_closing * dt, zero);
    elastic_before = Law::spring(law.stiffness, deep_before);
    outcome.normal_loss =
        only(touch & alive, 0.5 * mean_closing * ((impulse_before - elastic_before) + (impulse - elastic)));
  } else {
    // of the mean over the step the part of this contact is known, not only that of the last step
    mean_closing = half_mobility * (impulse_before - impulse) - geometry.middle_opening;
    outcome.normal_loss = (impulse - elastic) * mean_closing;
  }
  sums.deepest = larger(deep, sums.deepest);
  Lanes px = impulse * nx, py = impulse * ny;
  if constexpr (kind.friction) {
    auto stretch = load<Lanes>(slips->stretch);
    const auto slip_dashpot = load<Lanes>(slips->dashpot);
    const auto tangential_before = load<Lanes>(slips->impulse);
    const Lanes& share = geometry.share;
    Lanes velocity, mean_slip{}, mobility{};
    if constexpr (!kind.verlet) {
      mobility = half_mobility + load<Lanes>(slips->half_turning) * geometry.square;
      // without this contact's own part in it
      velocity = geometry.middle_slip - share * geometry.middle_rims - mobility * tangential_before;
    }
    if constexpr (kind.verlet) {
      const Lanes rims = share * geometry.rims;
      const Lanes now = geometry.along - rims;
      velocity = now;
      mean_slip = mean_slip_of(geometry, rims, now, mean_closing, dt);
      if (changes || numbers.now == 0) [[unlikely]]  // as of parts, whose places before are not known
        stretch += only(numbers.now == 0 ? touch : begun, (velocity - mean_slip) * dt);
    }
    const Lanes yield = law.friction * larger(impulse, zero);
    Tangent<Lanes> tangent = slide<kind.verlet, kind.equal>(law, slip_dashpot, stretch, velocity, mean_slip, mobility,
                                                            tangential_before, yield, dt);
    if constexpr (!kind.equal) tangent.impulse = only(touch, tangent.impulse);
    const Lanes tangential = -tangent.impulse;
    if (changes || !kind.equal) {
      const Bits<Lanes> lasting = kind.verlet ? touch & alive : touch;
      tangent.slip_loss = only(lasting, tangent.slip_loss);
      tangent.dashpot_loss = only(lasting, tangent.dashpot_loss);
    }
    if (changes) [[unlikely]] {
      const Lanes stored = law.half_spring * stretch * stretch;
      if constexpr (kind.verlet) {
        const FirstSlip<Lanes> first =
            first_slip_of(law, tangent, slip_dashpot * velocity, tangential, mean_slip, begun);
        tangent.slip_loss += first.slip_loss;
        tangent.dashpot_loss += first.dashpot_loss;
        add_release(only(ended, stored - 0.5 * tangential_before * mean_slip), sums);
      } else {
        add_release(only(ended, stored), sums);
      }
    }
    store(tangent.stretch, slips->stretch);
    store(tangential, slips->impulse);
    outcome.slip_loss = tangent.slip_loss;
    outcome.dashpot_loss = tangent.dashpot_loss;
    px -= tangential * ny;
    py += tangential * nx;
    outcome.rim = share * tangential;
  }
  outcome.px = px;
  outcome.py = py;
  if constexpr (kind.verlet) {
    if (changes) [[unlikely]]
      outcome.normal_loss += normal_loss_at_ends<Law>(begun, ended, mean_closing, impulse - elastic, impulse_before,
                                                      elastic_before, deep_before, dt);
  }
  if (numbers.record) {
    store(overlap, records->overlap);
    store(-opening, records->closing);
    store(nx, records->normal_x);
    store(ny, records->normal_y);
  }
}

/// Where the impulses of a group go.
struct Receivers {
  BodyImpulse* impulses = nullptr;
  BodyImpulse* outward = nullptr;  ///< next place for a body behind the block
  std::int32_t end = 0;            ///< of the bodies of the block
};

/// \tparam outward some bodies are behind the block
template <PairLoopKind kind, bool outward, class Lanes>
EQUIDEM_ALWAYS_INLINE void give(const PairGroup& group, const Outcome<Lanes>& outcome, Receivers& to,
                                LaneSums<Lanes>& sums) {
  if (!outcome.any) {
    for (std::size_t k = 0; outward && k < lanes_of_pairs; ++k) {
      if (group.j[k] >= to.end) *to.outward++ = {};
    }
    return;
  }
  Row<Lanes> row[lanes_of_pairs];
  if constexpr (kind.friction) {
    add_losses(outcome.normal_loss, outcome.slip_loss, outcome.dashpot_loss, sums);
    rows_of(outcome.px, outcome.py, Lanes{}, outcome.rim, row);
  } else {
    add_losses(outcome.normal_loss, sums);
    rows_of(outcome.px, outcome.py, Lanes{}, Lanes{}, row);
  }
  // of both bodies the rim is pushed the same way round, and its lever is the radius
  alignas(32) constexpr long long rim[4] = {0, 0, 0, std::numeric_limits<long long>::min()};
  const auto turned = load<Bits<Row<Lanes>>>(rim);
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    subtract(&to.impulses[group.i[k]], row[k]);
    if constexpr (kind.friction) row[k] = as<Row<Lanes>>(bits_of(row[k]) ^ turned);
    if (outward && group.j[k] >= to.end) {
      store(row[k], to.outward++);
    } else {
      add(&to.impulses[group.j[k]], row[k]);
    }
  }
}

template <class Law, PairLoopKind kind>
struct CollidePairs {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, std::size_t b);
};

template <class Law, PairLoopKind kind>
template <class Lanes>
void CollidePairs<Law, kind>::run(GrainSystem& system, std::size_t b) {
  const NearPairs& near = system.contacts.near;
  PairBlock& block = system.contacts.near.blocks[b];
  const PairLaw& law = near.law;
  const LoopNumbers<Lanes> numbers{
      law_lanes(all<Lanes>(law.stiffness), all<Lanes>(law.least), all<Lanes>(law.friction),
                all<Lanes>(law.tangential_stiffness), all<Lanes>(1 / law.tangential_stiffness), system.dt()),
      system.dt(), system.step + (system.options.verlet() ? 0 : 1), near.record, &system.bodies.sums[b]};
  block.records.resize(near.record ? block.groups.size() : 0);
  LaneSums<Lanes> sums;
  const PairBody* bodies = near.bodies.data();
  Receivers to{system.bodies.impulses.data(), block.outward.impulses.data(),
               static_cast<std::int32_t>(system.bodies.blocks.end(b))};
  Geometry<Lanes> geometry[groups_at_once];
  Outcome<Lanes> outcome[groups_at_once];
  const std::size_t count = block.groups.size();
  PairGroup* groups = block.groups.data();
  PairSlips* slips = block.slips.data();
  const PairLaws* laws = block.laws.data();
  PairRecords* records = block.records.data();
  for (std::size_t first = 0; first < count; first += groups_at_once) {
    const std::size_t here = std::min(groups_at_once, count - first);
    for (std::size_t g = 0; g < here; ++g) measure<kind>(bodies, groups[first + g], geometry[g]);
    for (std::size_t g = 0; g < here; ++g) {
      respond<Law, kind>(numbers, geometry[g], groups[first + g], kind.friction ? slips + (first + g) : nullptr,
                         kind.equal ? nullptr : laws + (first + g), near.record ? records + (first + g) : nullptr, sums,
                         outcome[g]);
    }
    if (first + here <= block.first_outward) {
      for (std::size_t g = 0; g < here; ++g) give<kind, false>(groups[first + g], outcome[g], to, sums);
    } else {
      for (std::size_t g = 0; g < here; ++g) give<kind, true>(groups[first + g], outcome[g], to, sums);
    }
  }
  add(sums, *numbers.block);
}

template <class Law, PairLoopKind kind>
NearPairs::Loop choose_pair_loop() {
  return by_vector_width<CollidePairs<Law, kind>, GrainSystem&, std::size_t>();
}

template <class Law, bool equal>
NearPairs::Loop choose_pair_loop(const GrainSystem& system) {
  if (system.options.verlet()) {
    return system.friction ? choose_pair_loop<Law, PairLoopKind{true, equal, true}>()
                           : choose_pair_loop<Law, PairLoopKind{false, equal, true}>();
  }
  return system.friction ? choose_pair_loop<Law, PairLoopKind{true, equal, false}>()
                         : choose_pair_loop<Law, PairLoopKind{false, equal, false}>();
}

}  // namespace

NearPairs::Loop near_pair_loop(const GrainSystem& system) {
  return visit_law(system.options.law, [&]<class Law>(std::type_identity<Law>) -> NearPairs::Loop {
    if constexpr (Law::kind == LawKind::force) {
      return system.contacts.near.equal ? choose_pair_loop<Law, true>(system) : choose_pair_loop<Law, false>(system);
    } else {
      return nullptr;
    }
  });
}

}  // namespace equidem
