// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors are passed between inlined functions only: no call depends on how.
#pragma GCC diagnostic ignored "-Wpsabi"
#include <algorithm>
#include <cmath>

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/pair_lanes.hpp"

namespace equidem {
namespace {

using namespace eight;

enum class Slip { none, explicitly, midpoint };

/// What a loop does, known where it is compiled.
struct PairLoopKind {
  bool hertz = false;
  Slip slip = Slip::none;
  bool equal = false;  ///< one law for all pairs, where the dashpot rests while contacts slide
};

struct LoopNumbers {
  PairLaw law;
  double tangential_compliance = 0;
  double dt = 0;
  std::int64_t now = 0;  ///< step before the one being made
  bool record = false;
};

struct Sums {
  Half
      lost{};  // normal dashpot, slip, tangential dashpot, release: one contact after another, so that pairs apart change no bit
  Lanes deepest{};
  Choice evaluations{}, begun{};
};

struct Law {
  Lanes stiffness, least, friction, tangential_stiffness, beyond_cap, tangential_compliance;
};

template <PairLoopKind kind>
EQUIDEM_ALWAYS_INLINE Law law_of(const LoopNumbers& numbers, const PairLaws* laws) {
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

/// sliding_step and sliding_step_midpoint for contacts that have a spring.
/// \param velocity slip at the start of the step; middle: by the midpoint rule, with half of what others do to it, and velocity is that too
struct Tangent {
  Lanes force, stretch, slip_loss, dashpot_loss;
};

template <PairLoopKind kind>
EQUIDEM_ALWAYS_INLINE Tangent slide(const Law& law, const Lanes& dashpot, const Lanes& stretch, const Lanes& velocity,
                                    const Lanes& middle, const Lanes& mobility, const Lanes& yield, double dt) {
  const Lanes spring = law.tangential_stiffness;
  Lanes resistance, mean = velocity;
  if constexpr (kind.slip == Slip::midpoint) {
    const Lanes rate = spring * (dt / 2) + dashpot;
    resistance = (spring * stretch + rate * velocity) / (1 + mobility * rate);
  } else {
    resistance = spring * (stretch + velocity * dt) + dashpot * velocity;
  }
  Lanes capped = resistance;
  if constexpr (!kind.equal) {
    if constexpr (kind.slip == Slip::midpoint) mean = velocity - mobility * resistance;
    capped -= law.beyond_cap * dashpot * mean;
  }
  const Choice slides = negative(yield - magnitude(capped));
  const Lanes friction = choose(slides, with_sign(yield, capped), resistance);
  Lanes drag{}, force = friction;
  if constexpr (kind.slip == Slip::midpoint) mean = velocity - mobility * friction;
  if constexpr (!kind.equal) {
    if constexpr (kind.slip == Slip::midpoint) {
      mean = choose(slides, mean / (1 + law.beyond_cap * mobility * dashpot), mean);
    }
    drag = only(slides, law.beyond_cap * dashpot * mean);
    force += drag;
  }
  const Lanes moved = stretch + mean * dt;
  const Lanes largest = yield * law.tangential_compliance;
  Lanes end = choose(slides, smaller(larger(moved, -largest), largest), moved);
  if constexpr (!kind.equal) end = spring > 0 ? end : Lanes{};
  const Lanes released = 0.5 * spring * (stretch - end) * (stretch + end);
  const Lanes dragged = choose(slides, drag, dashpot * mean);
  if constexpr (kind.slip == Slip::explicitly) mean = middle - mobility * force;
  return {force, end, only(slides, friction * mean * dt + released), dragged * mean * dt};
}

template <PairLoopKind kind>
EQUIDEM_ALWAYS_INLINE void collide_group(const LoopNumbers& numbers, const PairBody* bodies, Push* pushes,
                                         PairGroup& group, PairSlips* slips, const PairLaws* laws, PairRecords* records,
                                         Sums& sums) {
  constexpr bool friction = kind.slip != Slip::none;
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
  if (any(touch ^ alive)) {
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
  const Law law = law_of<kind>(numbers, laws);
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
  // of the mean over the step the part of this contact is known, not only that of the last step
  const Lanes mass = load(group.mass);
  const Lanes mean_closing = 0.5 * mass * (load(group.impulse) - impulse) - (m[5] * nx + m[6] * ny);
  store(impulse, group.impulse);
  const Lanes normal_loss = only(touch, (force - elastic) * mean_closing * dt);
  sums.deepest = larger(deep, sums.deepest);
  Lanes px = impulse * nx, py = impulse * ny;
  Half row[8];
  if constexpr (friction) {
    const Lanes stretch = load(slips->stretch);
    const Lanes half = 0.5 * (mass + load(slips->turning) * square);
    const Lanes share = distance / reach;
    // without this contact's own part in it
    const Lanes middle = (m[6] * nx - m[5] * ny) - share * m[7] - half * load(slips->impulse);
    const Lanes velocity = kind.slip == Slip::midpoint ? middle : (v * nx - u * ny) - share * m[4];
    const Lanes yield = law.friction * larger(force, zero);
    const Tangent tangent = slide<kind>(law, load(slips->dashpot), stretch, velocity, middle, dt * half, yield, dt);
    const Lanes tangential = only(touch, -dt * tangent.force);
    store(only(touch, tangent.stretch), slips->stretch);
    store(tangential, slips->impulse);
    const Lanes release = only(ended, 0.5 * law.tangential_stiffness * stretch * stretch);
    rows_of(normal_loss, only(touch, tangent.slip_loss), only(touch, tangent.dashpot_loss), release, row);
    for (const Half& lost : row) sums.lost += lost;
    px -= tangential * ny;
    py += tangential * nx;
    rows_of(px, py, zero, share * tangential, row);
  } else {
    for (int k = 0; k < 8; ++k) sums.lost[0] += normal_loss[k];
    rows_of(px, py, zero, zero, row);
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
    if constexpr (friction) row[k] = reinterpret_cast<Half>(reinterpret_cast<HalfChoice>(row[k]) ^ turned);
    add(&pushes[group.j[k]], row[k]);
  }
}

template <PairLoopKind kind>
EQUIDEM_ALWAYS_INLINE void collide_all(GrainSystem& system) {
  NearPairs& near = system.near;
  const bool verlet = system.options.scheme == GrainOptions::Scheme::velocity_verlet;
  const LoopNumbers numbers{near.law, 1 / near.law.tangential_stiffness, system.dt(), system.step - (verlet ? 1 : 0),
                            near.record};
  near.records.resize(near.record ? near.groups.size() : 0);
  Sums sums;
  const PairBody* bodies = near.bodies.data();
  Push* pushes = system.pushes.data();
  for (std::size_t g = 0; g < near.groups.size(); ++g) {
    collide_group<kind>(
        numbers, bodies, pushes, near.groups[g], kind.slip == Slip::none ? nullptr : near.slips.data() + g,
        kind.equal ? nullptr : near.laws.data() + g, near.record ? near.records.data() + g : nullptr, sums);
  }
  system.lost.lost_dashpot += sums.lost[0];
  system.lost.lost_slip += sums.lost[1];
  system.lost.lost_tangential_dashpot += sums.lost[2];
  system.lost.lost_release += sums.lost[3];
  for (int k = 0; k < 8; ++k) {
    system.counters.evaluations += sums.evaluations[k];
    system.counters.contacts += sums.begun[k];
    if (sums.evaluations[k] > 0) system.free_flight = false;
    system.deepest = std::max(system.deepest, sums.deepest[k]);
  }
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
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) {
    return collide_by_eights<kind>;
  }
  if (__builtin_cpu_supports("avx2")) return collide_by_fours<kind>;
#endif
  return collide_plain<kind>;
}

template <bool hertz, bool equal>
NearPairs::Loop choose(const GrainSystem& system) {
  if (!system.friction) return choose<PairLoopKind{hertz, Slip::none, equal}>();
  const bool explicitly = system.options.scheme == GrainOptions::Scheme::velocity_verlet;
  return explicitly ? choose<PairLoopKind{hertz, Slip::explicitly, equal}>()
                    : choose<PairLoopKind{hertz, Slip::midpoint, equal}>();
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
