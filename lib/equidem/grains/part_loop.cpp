// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors are passed between inlined functions only: no call depends on how.
#pragma GCC diagnostic ignored "-Wpsabi"
#include <algorithm>
#include <cmath>

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/part_lanes.hpp"

namespace equidem {
namespace {

using namespace eight;

struct PartLoopKind {
  bool round = false, friction = false;
};

struct LoopNumbers {
  double dt = 0;
  std::int64_t now = 0;  ///< step before the one being made
  bool hertz = false, record = false;
};

struct Sums {
  Half lost{};  ///< normal dashpot, slip, tangential dashpot, release: one contact after another
  Lanes deepest{};
  Choice evaluations{}, begun{};
};

/// sliding_step_midpoint() for contacts that have a spring, or no friction.
struct Tangent {
  Lanes force, stretch, slip_loss, dashpot_loss;
};

EQUIDEM_ALWAYS_INLINE Tangent slide(const PartGroup& group, const Lanes& dashpot, const Lanes& stretch,
                                    const Lanes& velocity, const Lanes& mobility, const Lanes& yield, double dt) {
  const Lanes spring = load(group.numbers[PartGroup::tangential_stiffness]);
  const Lanes beyond_cap = load(group.numbers[PartGroup::beyond_cap]) * dashpot;
  const Choice has_spring = negative(Lanes{} - spring);
  const Lanes rate = spring * (dt / 2) + dashpot;
  const Lanes resistance = (spring * stretch + rate * velocity) / (1 + mobility * rate);
  const Lanes capped = resistance - beyond_cap * (velocity - mobility * resistance);
  const Choice slides = negative(yield - magnitude(capped));
  Lanes mean = velocity - mobility * resistance;
  if (!any(slides)) return {resistance, only(has_spring, stretch + mean * dt), Lanes{}, dashpot * mean * mean * dt};
  const Lanes friction = choose(slides, with_sign(yield, capped), resistance);
  mean = choose(slides, (velocity - mobility * friction) / (1 + mobility * beyond_cap), mean);
  const Lanes drag = only(slides, beyond_cap * mean);
  const Lanes moved = stretch + mean * dt, largest = yield / choose(has_spring, spring, all(1));
  const Lanes end = only(has_spring, choose(slides, smaller(larger(moved, -largest), largest), moved));
  const Lanes released = 0.5 * spring * (stretch - end) * (stretch + end);
  const Lanes dragged = choose(slides, drag, dashpot * mean);
  return {friction + drag, end, only(slides, friction * mean * dt + released), dragged * mean * dt};
}

template <PartLoopKind kind>
EQUIDEM_ALWAYS_INLINE void collide_group(const LoopNumbers& numbers, const PartBody* bodies,
                                         const std::int32_t* body_of_part, Push* pushes, PartGroup& group, Sums& sums) {
  const double dt = numbers.dt;
  Choice since;
  std::memcpy(&since, group.since, sizeof since);
  const Choice used = ~negative(since - PairGroup::apart), alive = ~negative(since - (PairGroup::apart + 1));
  const Standing s = standing_of(bodies, group);
  Meetings at;
  if constexpr (kind.round) {
    at = meetings_of_round_parts(group, s, used);
  } else {
    at = meetings_of_ellipses(group, bodies, s, used, alive);
  }
  const Choice touch = at.touch, begun = touch & ~alive, ended = alive & ~touch;
  if (any(touch ^ alive)) {
    since = choose(begun, Choice{} + numbers.now,
                   choose(ended, Choice{} + static_cast<long long>(PairGroup::apart), since));
    std::memcpy(group.since, &since, sizeof since);
    sums.begun -= begun;
  } else if (!any(touch)) {
    return;
  }
  sums.evaluations -= touch;

  const Vectors n = at.normal, t = perpendicular(n);
  const Lanes across_i = cross(at.arm_i, n), across_j = cross(at.arm_j, n);
  const Lanes closing = -(dot(s.velocity, n) + (s.spin_j * across_j - s.spin_i * across_i));
  const Lanes inverse_mass = load(group.numbers[PartGroup::inverse_mass]);
  const Lanes turning_i = load(group.numbers[PartGroup::inverse_moment_i]),
              turning_j = load(group.numbers[PartGroup::inverse_moment_j]);
  const Lanes deep = only(touch, at.overlap);
  Lanes elastic = load(group.numbers[PartGroup::stiffness]) * deep,
        drag = load(group.numbers[PartGroup::dashpot]) * closing;
  if (numbers.hertz) {
    const Lanes root = square_root(deep);
    elastic *= root;
    drag *= square_root(root);
  }
  const Lanes force = only(touch, larger(elastic + drag, load(group.numbers[PartGroup::least])));
  const Lanes impulse = force * dt;
  // of the mean over the step the part of this contact is known, not only that of the last step
  const Lanes mobility = inverse_mass + across_i * across_i * turning_i + across_j * across_j * turning_j;
  const Lanes mean_closing = 0.5 * mobility * (load(group.numbers[PartGroup::impulse]) - impulse) -
                             (dot(s.middle, n) + (s.middle_spin_j * across_j - s.middle_spin_i * across_i));
  store(impulse, group.numbers[PartGroup::impulse]);
  const Lanes normal_loss = only(touch, (force - elastic) * mean_closing * dt);
  sums.deepest = larger(deep, sums.deepest);
  Vectors push = impulse * n;
  Lanes torque_i = impulse * across_i, torque_j = impulse * across_j;
  Half row[8];
  if constexpr (kind.friction) {
    const Lanes along_i = dot(at.arm_i, n), along_j = dot(at.arm_j, n);
    const Lanes rim_i = along_i + at.sunk_i, rim_j = along_j - at.sunk_j;
    const Lanes half = 0.5 * (inverse_mass + along_i * along_i * turning_i + along_j * along_j * turning_j);
    const Lanes at_rim = inverse_mass + rim_i * rim_i * turning_i + rim_j * rim_j * turning_j;
    const Lanes dashpot = load(group.numbers[PartGroup::tangential_damping]) * square_root(1 / at_rim);
    // without this contact's own part in it
    const Lanes middle = dot(s.middle, t) + (s.middle_spin_j * along_j - s.middle_spin_i * along_i) -
                         half * load(group.numbers[PartGroup::tangential_impulse]);
    const Lanes yield = load(group.numbers[PartGroup::friction]) * larger(force, Lanes{});
    const Lanes stretch = load(group.numbers[PartGroup::stretch]);
    const Tangent tangent = slide(group, dashpot, stretch, middle, dt * half, yield, dt);
    const Lanes tangential = only(touch, -dt * tangent.force);
    store(only(touch, tangent.stretch), group.numbers[PartGroup::stretch]);
    store(tangential, group.numbers[PartGroup::tangential_impulse]);
    const Lanes release = only(ended, 0.5 * load(group.numbers[PartGroup::tangential_stiffness]) * stretch * stretch);
    rows_of(normal_loss, only(touch, tangent.slip_loss), only(touch, tangent.dashpot_loss), release, row);
    for (const Half& lost : row) sums.lost += lost;
    push = push + tangential * t;
    torque_i += tangential * along_i;
    torque_j += tangential * along_j;
  } else {
    for (int k = 0; k < 8; ++k) sums.lost[0] += normal_loss[k];
  }
  if (numbers.record) {
    store(at.overlap, group.numbers[PartGroup::overlap]);
    store(closing, group.numbers[PartGroup::closing]);
    store(at.arm_i.x, group.numbers[PartGroup::arm_i_x]);
    store(at.arm_i.y, group.numbers[PartGroup::arm_i_y]);
    store(at.arm_j.x, group.numbers[PartGroup::arm_j_x]);
    store(at.arm_j.y, group.numbers[PartGroup::arm_j_y]);
  }
  if constexpr (kind.round) {
    store(n.x, group.numbers[PartGroup::normal_x]);
    store(n.y, group.numbers[PartGroup::normal_y]);
  }
  const Choice on = touch;
  Half other[8];
  rows_of(only(on, push.x), only(on, push.y), only(on, torque_i), Lanes{}, row);
  rows_of(only(on, push.x), only(on, push.y), only(on, torque_j), Lanes{}, other);
  for (int k = 0; k < 8; ++k) {
    subtract(&pushes[body_of_part[group.i[k]]], row[k]);
    add(&pushes[body_of_part[group.j[k]]], other[k]);
  }
}

template <PartLoopKind kind>
EQUIDEM_ALWAYS_INLINE void collide_all(GrainSystem& system, NearParts::List& list) {
  const LoopNumbers numbers{system.dt(), system.step - (system.options.verlet() ? 1 : 0),
                            system.options.law == NormalLaw::hertz_dashpot, system.near.record};
  Sums sums;
  for (PartGroup& group : list.groups) {
    collide_group<kind>(numbers, system.near_parts.bodies.data(), system.body_of_part.data(), system.pushes.data(),
                        group, sums);
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

template <PartLoopKind kind>
void collide_plain(GrainSystem& system, NearParts::List& list) {
  collide_all<kind>(system, list);
}

#if defined(__x86_64__)
/// No products and sums fused: the same bits on every machine.
template <PartLoopKind kind>
__attribute__((target("avx2"))) void collide_by_fours(GrainSystem& system, NearParts::List& list) {
  collide_all<kind>(system, list);
}
template <PartLoopKind kind>
__attribute__((target("avx2,avx512f,avx512vl,avx512dq,prefer-vector-width=512"))) void collide_by_eights(
    GrainSystem& system, NearParts::List& list) {
  collide_all<kind>(system, list);
}
#endif

template <PartLoopKind kind>
NearParts::List::Loop choose_loop() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) {
    return collide_by_eights<kind>;
  }
  if (__builtin_cpu_supports("avx2")) return collide_by_fours<kind>;
#endif
  return collide_plain<kind>;
}

}  // namespace

NearParts::List::Loop near_part_loop(const GrainSystem& system, bool round) {
  if (system.friction) {
    return round ? choose_loop<PartLoopKind{true, true}>() : choose_loop<PartLoopKind{false, true}>();
  }
  return round ? choose_loop<PartLoopKind{true, false}>() : choose_loop<PartLoopKind{false, false}>();
}

}  // namespace equidem
