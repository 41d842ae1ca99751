// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors are passed between inlined functions only: no call depends on how.
#pragma GCC diagnostic ignored "-Wpsabi"
#include <algorithm>
#include <cmath>

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/lane_sums.hpp"
#include "equidem/grains/pair_lanes.hpp"
#include "equidem/grains/slide_lanes.hpp"
#include "equidem/grains/touch_lanes.hpp"

namespace equidem {
namespace {

using namespace eight;

/// What a loop does, known where it is compiled.
struct PairLoopKind {
  bool hertz = false;
  bool friction = false;
  bool equal = false;   ///< one law for all pairs, where the dashpot rests while contacts slide
  bool verlet = false;  ///< friction by the explicit step, else by the midpoint rule
};

struct LoopNumbers {
  PairLaw law;
  double tangential_compliance = 0;
  double dt = 0;
  std::int64_t now = 0;  ///< step before the one being made
  bool corrected = false;
  bool record = false;
  GrainSystem* system = nullptr;
};

template <PairLoopKind kind>
EQUIDEM_ALWAYS_INLINE LawLanes law_of(const LoopNumbers& numbers, const PairLaws* laws) {
  if constexpr (kind.equal) {
    const PairLaw& law = numbers.law;
    return {all(law.stiffness),
            all(law.least),
            all(law.friction),
            all(law.tangential_stiffness),
            Lanes{},
            all(numbers.tangential_compliance)};
  } else {
    const Lanes spring = load(laws->tangential_stiffness);
    return {load(laws->stiffness),  load(laws->least),
            load(laws->friction),   spring,
            load(laws->beyond_cap), 1 / (spring > 0 ? spring : all(1))};
  }
}

template <PairLoopKind kind>
EQUIDEM_ALWAYS_INLINE void collide_group(const LoopNumbers& numbers, const PairBody* bodies, Push* pushes,
                                         PairGroup& group, PairSlips* slips, const PairLaws* laws, PairRecords* records,
                                         LaneSums& sums) {
  const double dt = numbers.dt;
  // differences j - i, sums of the speeds of the rims
  constexpr long long minus = std::numeric_limits<long long>::min();
  const Choice difference = {minus, minus, minus, minus, 0, minus, minus, 0};
  Lanes m[8];
  for (int k = 0; k < 8; ++k) {
    const Lanes i = load(&bodies[group.i[k]].position.x);
    const Lanes j = load(&bodies[group.j[k]].position.x);
    m[k] = j + reinterpret_cast<Lanes>(reinterpret_cast<Choice>(i) ^ difference);
  }
  transpose(m);
  const Lanes &bx = m[0], &by = m[1], &u = m[2], &v = m[3];
  const Lanes reach = load(group.reach);
  const Lanes square = bx * bx + by * by;
  const Lanes distance = square_root(square);
  const Lanes overlap = reach - distance;
  Choice since;
  std::memcpy(&since, group.since, sizeof since);
  const Lanes zero{};
  const Choice touch = negative(zero - overlap) & ~negative(since - PairGroup::apart);
  const Choice alive = ~negative(since - (PairGroup::apart + 1));
  const Choice begun = touch & ~alive, ended = alive & ~touch;
  const bool changes = any(touch ^ alive);
  if (changes) {
    since = choose(begun, Choice{} + numbers.now,
                   choose(ended, Choice{} + static_cast<long long>(PairGroup::apart), since));
    std::memcpy(group.since, &since, sizeof since);
    sums.begun -= begun;
  } else if (!any(touch)) {
    return;
  }
  sums.evaluations -= touch;

  const Choice distinct = square > 0;
  const Lanes inverse = distance * (1 / square);  // the division need not wait for the root
  const Lanes nx = distinct ? bx * inverse : all(1), ny = distinct ? by * inverse : zero;
  const Lanes closing = -(u * nx + v * ny);
  const LawLanes law = law_of<kind>(numbers, laws);
  const Lanes dashpot = load(group.dashpot);
  const Lanes deep = only(touch, overlap);
  Lanes elastic, drag;
  if constexpr (kind.hertz) {
    const Lanes root = square_root(deep);
    elastic = law.stiffness * deep * root;
    drag = dashpot * square_root(root) * closing;
  } else {
    elastic = law.stiffness * deep;
    drag = dashpot * closing;
  }
  const Lanes force = only(touch, larger(elastic + drag, law.least));
  const Lanes impulse = force * dt;
  const Lanes mass = load(group.mass), impulse_before = load(group.impulse);
  store(impulse, group.impulse);
  const Lanes along = v * nx - u * ny;
  Lanes mean_closing, deep_before, elastic_before, normal_loss;
  if constexpr (kind.verlet) {
    // over the drift, in which the normal turns; the dashpot gives half of the kicks before and after it each
    mean_closing = closing + (0.5 * dt) * inverse * along * along;
    deep_before = larger(overlap - mean_closing * dt, zero);
    elastic_before = law.stiffness * deep_before;
    if constexpr (kind.hertz) elastic_before *= square_root(deep_before);
    normal_loss =
        only(touch & alive, 0.5 * mean_closing * ((impulse_before - elastic_before * dt) + (force - elastic) * dt));
  } else {
    // of the mean over the step the part of this contact is known, not only that of the last step
    mean_closing = 0.5 * mass * (impulse_before - impulse) - (m[5] * nx + m[6] * ny);
    normal_loss = only(touch, (force - elastic) * mean_closing * dt);
  }
  sums.deepest = larger(deep, sums.deepest);
  Lanes slip{}, tangential_kick{}, sticking_dashpot{}, kept{};
  Choice slides{};
  Lanes px = impulse * nx, py = impulse * ny;
  Half row[8];
  if constexpr (kind.friction) {
    Lanes stretch = load(slips->stretch);
    const Lanes impulse_along_before = load(slips->impulse);
    const Lanes share = distance / reach;
    Lanes velocity, mean_slip{}, half{};
    if constexpr (kind.verlet) {
      const Lanes rims = share * m[4];
      velocity = along - rims;
      mean_slip = velocity - ((0.5 * dt) * closing * inverse) * (along + rims);
      if (changes && numbers.corrected) [[unlikely]] {
        const Lanes way = mean_closing * dt;
        const Lanes before_touch = only(begun & negative(overlap - way), 1 - overlap / way);
        stretch -= before_touch * velocity * dt;
      }
    } else {
      half = 0.5 * (mass + load(slips->turning) * square);
      // without this contact's own part in it
      velocity = (m[6] * nx - m[5] * ny) - share * m[7] - half * impulse_along_before;
    }
    const Lanes yield = law.friction * larger(force, zero);
    const Lanes slip_dashpot = load(slips->dashpot);
    const Tangent tangent = slide<kind.verlet, kind.equal>(law, slip_dashpot, stretch, velocity, mean_slip, dt * half,
                                                           impulse_along_before, yield, dt);
    const Lanes tangential = only(touch, -dt * tangent.force);
    store(only(touch, tangent.stretch), slips->stretch);
    store(tangential, slips->impulse);
    Choice lasting = touch;
    Lanes release{};
    if constexpr (kind.verlet) {
      lasting = touch & alive;
      slip = mean_slip;
      slides = tangent.slides;
      tangential_kick = choose(begun, tangential, impulse_along_before);
      sticking_dashpot = only(begun & ~slides, -dt * slip_dashpot * velocity);
      kept = choose(begun, tangent.stretch, stretch);
    } else {
      release = only(ended, 0.5 * law.tangential_stiffness * stretch * stretch);
    }
    rows_of(normal_loss, only(lasting, tangent.slip_loss), only(lasting, tangent.dashpot_loss), release, row);
    for (const Half& lost : row) sums.lost += lost;
    px -= tangential * ny;
    py += tangential * nx;
    rows_of(px, py, zero, share * tangential, row);
  } else {
    for (int k = 0; k < 8; ++k) sums.lost[0] += normal_loss[k];
    rows_of(px, py, zero, zero, row);
  }
  if constexpr (kind.verlet) {
    if (changes) [[unlikely]] {
      Lanes lever;
      for (int k = 0; k < 8; ++k) lever[k] = numbers.system->bodies[static_cast<std::size_t>(group.i[k])].radius;
      lever = lever / reach * distance;
      const Lanes other = lever - distance;
      count_instants(*numbers.system, {begun,
                                       ended,
                                       slides,
                                       group.i,
                                       group.j,
                                       nx,
                                       ny,
                                       lever * nx,
                                       lever * ny,
                                       other * nx,
                                       other * ny,
                                       mean_closing,
                                       slip,
                                       choose(begun, deep, deep_before),
                                       choose(begun, elastic, elastic_before) * dt,
                                       choose(begun, impulse, impulse_before),
                                       dashpot,
                                       mass,
                                       law.least,
                                       tangential_kick,
                                       sticking_dashpot,
                                       0.5 * law.tangential_stiffness * kept * kept});
    }
  }
  if (numbers.record) {
    store(overlap, records->overlap);
    store(closing, records->closing);
    store(nx, records->normal_x);
    store(ny, records->normal_y);
  }
  // of both bodies the rim is pushed the same way round, and its lever is the radius
  const HalfChoice turned = {0, 0, 0, minus};
  for (int k = 0; k < 8; ++k) {
    subtract(&pushes[group.i[k]], row[k]);
    if constexpr (kind.friction) row[k] = reinterpret_cast<Half>(reinterpret_cast<HalfChoice>(row[k]) ^ turned);
    add(&pushes[group.j[k]], row[k]);
  }
}

template <PairLoopKind kind>
EQUIDEM_ALWAYS_INLINE void collide_all(GrainSystem& system) {
  NearPairs& near = system.near;
  const bool verlet = system.options.verlet();
  const LoopNumbers numbers{near.law,
                            1 / near.law.tangential_stiffness,
                            system.dt(),
                            system.step - (verlet ? 1 : 0),
                            system.options.scheme == GrainOptions::Scheme::corrected_verlet,
                            near.record,
                            &system};
  near.records.resize(near.record ? near.groups.size() : 0);
  LaneSums sums;
  const PairBody* bodies = near.bodies.data();
  Push* pushes = system.pushes.data();
  for (std::size_t g = 0; g < near.groups.size(); ++g) {
    collide_group<kind>(numbers, bodies, pushes, near.groups[g], kind.friction ? near.slips.data() + g : nullptr,
                        kind.equal ? nullptr : near.laws.data() + g, near.record ? near.records.data() + g : nullptr,
                        sums);
  }
  add(sums, system);
}

template <PairLoopKind kind>
void collide_plain(GrainSystem& system) {
  collide_all<kind>(system);
}

#if defined(__x86_64__)
/// No products and sums fused: the same bits on every machine.
template <PairLoopKind kind>
__attribute__((target("avx2"))) void collide_by_fours(GrainSystem& system) {
  collide_all<kind>(system);
}
template <PairLoopKind kind>
__attribute__((target("avx2,avx512f,avx512vl,avx512dq,prefer-vector-width=512"))) void collide_by_eights(
    GrainSystem& system) {
  collide_all<kind>(system);
}
#endif

template <PairLoopKind kind>
NearPairs::Loop choose() {
#if defined(__x86_64__)
  if (has_512_bits()) return collide_by_eights<kind>;
  if (__builtin_cpu_supports("avx2")) return collide_by_fours<kind>;
#endif
  return collide_plain<kind>;
}

template <bool hertz, bool equal>
NearPairs::Loop choose(const GrainSystem& system) {
  if (system.options.verlet()) {
    return system.friction ? choose<PairLoopKind{hertz, true, equal, true}>()
                           : choose<PairLoopKind{hertz, false, equal, true}>();
  }
  return system.friction ? choose<PairLoopKind{hertz, true, equal, false}>()
                         : choose<PairLoopKind{hertz, false, equal, false}>();
}

}  // namespace

NearPairs::Loop near_pair_loop(const GrainSystem& system) {
  const bool equal = system.near.equal;
  if (system.options.law == NormalLaw::hertz_dashpot) {
    return equal ? choose<true, true>(system) : choose<true, false>(system);
  }
  return equal ? choose<false, true>(system) : choose<false, false>(system);
}

}  // namespace equidem
