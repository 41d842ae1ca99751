// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/contact/laws/visit.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/lane_sums.hpp"
#include "equidem/grains/kernels/part_lanes.hpp"
#include "equidem/grains/kernels/slide_lanes.hpp"
#include "equidem/grains/kernels/touch_lanes.hpp"
#include "equidem/grains/kernels/vector_width.hpp"

namespace equidem {
namespace {

using namespace eight;

struct PartLoopKind {
  bool round = false, friction = false, verlet = false;
};

struct PartLoopNumbers {
  double dt = 0;
  std::int64_t now = 0;  ///< step before the one being made
  bool corrected = false, record = false;
  const GrainSystem* system = nullptr;
  BlockSums* block = nullptr;
  std::int32_t end = 0;  ///< of the bodies of the block
};

EQUIDEM_ALWAYS_INLINE Lanes closing_of(const Standing& s, const Vectors& n, const Vectors& arm_i,
                                       const Vectors& arm_j) {
  return -(dot(s.velocity, n) + (s.spin_j * cross(arm_j, n) - s.spin_i * cross(arm_i, n)));
}
EQUIDEM_ALWAYS_INLINE Lanes slip_of(const Standing& s, const Vectors& n, const Vectors& arm_i, const Vectors& arm_j) {
  return cross(n, s.velocity) + (s.spin_j * dot(arm_j, n) - s.spin_i * dot(arm_i, n));
}

EQUIDEM_ALWAYS_INLINE LawLanes law_of(const PartGroup& group) {
  const Lanes spring = load(group.numbers[PartGroup::tangential_stiffness]);
  return {load(group.numbers[PartGroup::stiffness]),  load(group.numbers[PartGroup::least]),
          load(group.numbers[PartGroup::friction]),   spring,
          load(group.numbers[PartGroup::beyond_cap]), 1 / (spring > 0 ? spring : all(1))};
}

/// \param[in,out] outward next place for the impulse on a body behind the block; null: no body of the group is there
template <class Law, PartLoopKind kind>
EQUIDEM_ALWAYS_INLINE void collide_group(const PartLoopNumbers& numbers, const PartBody* bodies,
                                         const std::int32_t* body_of_part, BodyImpulse* impulses, PartGroup& group,
                                         BodyImpulse*& outward, LaneSums& sums) {
  const double dt = numbers.dt;
  Choice since;
  std::memcpy(&since, group.since, sizeof since);
  const Choice used = ~negative(since - PairGroup::apart), alive = ~negative(since - (PairGroup::apart + 1));
  const Standing s = standing_of<kind.round>(bodies, group);
  const Vectors normal_before{load(group.numbers[PartGroup::normal_x]), load(group.numbers[PartGroup::normal_y])};
  GeometryLanes at;
  if constexpr (kind.round) {
    at = geometry_of_round_parts(group, s, used);
  } else {
    at = geometry_of_ellipses(group, s, used, alive);
  }
  const Choice touch = at.touch, begun = touch & ~alive, ended = alive & ~touch;
  const bool changes = any(touch ^ alive);
  if (changes) {
    since = choose(begun, Choice{} + numbers.now,
                   choose(ended, Choice{} + static_cast<long long>(PairGroup::apart), since));
    std::memcpy(group.since, &since, sizeof since);
    sums.begun -= begun;
  } else if (!any(touch)) {
    for (int k = 0; outward && k < 8; ++k) {
      if (body_of_part[group.j[k]] >= numbers.end) *outward++ = {};
    }
    return;
  }
  sums.evaluations -= touch;

  const Vectors n = at.normal, t = perpendicular(n);
  const Lanes across_i = cross(at.arm_i, n), across_j = cross(at.arm_j, n);
  const Lanes closing = -(dot(s.velocity, n) + (s.spin_j * across_j - s.spin_i * across_i));
  const Lanes inverse_mass = load(group.numbers[PartGroup::inverse_mass]);
  const Lanes turning_i = load(group.numbers[PartGroup::inverse_moment_i]),
              turning_j = load(group.numbers[PartGroup::inverse_moment_j]);
  const Lanes stiffness = load(group.numbers[PartGroup::stiffness]), least = load(group.numbers[PartGroup::least]);
  const Lanes dashpot = load(group.numbers[PartGroup::dashpot]);
  const Lanes deep = only(touch, at.overlap);
  const Lanes elastic = Law::spring(stiffness, deep), drag = Law::dashpot(dashpot, deep) * closing;
  const Lanes force = only(touch, larger(elastic + drag, least));
  const Lanes impulse = force * dt, impulse_before = load(group.numbers[PartGroup::impulse]);
  store(impulse, group.numbers[PartGroup::impulse]);
  Lanes normal_loss, mean_closing, deep_before, elastic_before;
  Vectors arm_i_before, arm_j_before;
  if constexpr (kind.verlet) {
    // over the drift, from the places at both ends of it; the dashpot gives half of the kicks before and after it each
    arm_i_before = {load(group.numbers[PartGroup::arm_i_x]), load(group.numbers[PartGroup::arm_i_y])};
    arm_j_before = {load(group.numbers[PartGroup::arm_j_x]), load(group.numbers[PartGroup::arm_j_y])};
    mean_closing = choose(begun, closing, closing_of(s, normal_before, arm_i_before, arm_j_before));
    mean_closing = choose(ended, mean_closing, 0.5 * (closing + mean_closing));
    deep_before = larger(load(group.numbers[PartGroup::overlap]), Lanes{});
    elastic_before = Law::spring(stiffness, deep_before);
    normal_loss =
        only(touch & alive, 0.5 * mean_closing * ((impulse_before - elastic_before * dt) + (force - elastic) * dt));
  } else {
    // of the mean over the step the part of this contact is known, not only that of the last step
    const Lanes mobility = inverse_mass + across_i * across_i * turning_i + across_j * across_j * turning_j;
    mean_closing = 0.5 * mobility * (impulse_before - impulse) -
                   (dot(s.middle, n) + (s.middle_spin_j * across_j - s.middle_spin_i * across_i));
    normal_loss = only(touch, (force - elastic) * mean_closing * dt);
  }
  sums.deepest = larger(deep, sums.deepest);
  Vectors push = impulse * n;
  Lanes torque_i = impulse * across_i, torque_j = impulse * across_j;
  Lanes mean_slip{}, tangential_kick{}, sticking_dashpot{}, stored{};
  Choice slides{};
  Half row[8];
  if constexpr (kind.friction) {
    const LawLanes law = law_of(group);
    const Lanes along_i = dot(at.arm_i, n), along_j = dot(at.arm_j, n);
    const Lanes rim_i = along_i + at.sunk_i, rim_j = along_j - at.sunk_j;
    const Lanes at_rim = inverse_mass + rim_i * rim_i * turning_i + rim_j * rim_j * turning_j;
    const Lanes slip_dashpot = load(group.numbers[PartGroup::tangential_damping]) * square_root(1 / at_rim);
    const Lanes tangential_before = load(group.numbers[PartGroup::tangential_impulse]);
    const Lanes yield = law.friction * larger(force, Lanes{});
    Lanes stretch = load(group.numbers[PartGroup::stretch]);
    Lanes velocity, half{};
    if constexpr (kind.verlet) {
      velocity = dot(s.velocity, t) + (s.spin_j * along_j - s.spin_i * along_i);
      mean_slip = choose(begun, velocity, slip_of(s, normal_before, arm_i_before, arm_j_before));
      mean_slip = choose(ended, mean_slip, 0.5 * (velocity + mean_slip));
      if (changes && numbers.corrected) [[unlikely]] {
        const Lanes way = mean_closing * dt;
        const Lanes before_touch = only(begun & negative(deep - way), 1 - deep / way);
        stretch -= before_touch * velocity * dt;
      }
    } else {
      half = 0.5 * (inverse_mass + along_i * along_i * turning_i + along_j * along_j * turning_j);
      // without this contact's own part in it
      velocity = dot(s.middle, t) + (s.middle_spin_j * along_j - s.middle_spin_i * along_i) - half * tangential_before;
    }
    const Tangent tangent = slide<kind.verlet, false>(law, slip_dashpot, stretch, velocity, mean_slip, dt * half,
                                                      tangential_before, yield, dt);
    const Lanes tangential = only(touch, -dt * tangent.force);
    store(only(touch, tangent.stretch), group.numbers[PartGroup::stretch]);
    store(tangential, group.numbers[PartGroup::tangential_impulse]);
    Choice lasting = touch;
    Lanes release{};
    if constexpr (kind.verlet) {
      lasting = touch & alive;
      slides = tangent.slides;
      tangential_kick = choose(begun, tangential, tangential_before);
      sticking_dashpot = only(begun & ~slides, -dt * slip_dashpot * velocity);
      const Lanes kept = choose(begun, tangent.stretch, stretch);
      stored = 0.5 * law.tangential_stiffness * kept * kept;
    } else {
      release = only(ended, 0.5 * law.tangential_stiffness * stretch * stretch);
    }
    rows_of(normal_loss, only(lasting, tangent.slip_loss), only(lasting, tangent.dashpot_loss), release, row);
    for (const Half& lost : row) sums.lost += lost;
    push = push + tangential * t;
    torque_i += tangential * along_i;
    torque_j += tangential * along_j;
  } else {
    for (int k = 0; k < 8; ++k) sums.lost[0] += normal_loss[k];
  }
  if constexpr (kind.verlet) {
    if (changes) [[unlikely]] {
      std::int32_t i[8], j[8];
      for (int k = 0; k < 8; ++k) {
        i[k] = body_of_part[group.i[k]];
        j[k] = body_of_part[group.j[k]];
      }
      const Vectors normal = choose(begun, n, normal_before);
      const Vectors arm_i = choose(begun, at.arm_i, arm_i_before), arm_j = choose(begun, at.arm_j, arm_j_before);
      count_instants(*numbers.system,
                     {begun,
                      ended,
                      slides,
                      i,
                      j,
                      normal.x,
                      normal.y,
                      arm_i.x,
                      arm_i.y,
                      arm_j.x,
                      arm_j.y,
                      mean_closing,
                      mean_slip,
                      choose(begun, deep, deep_before),
                      choose(begun, elastic, elastic_before) * dt,
                      choose(begun, impulse, impulse_before),
                      dashpot,
                      inverse_mass,
                      least,
                      tangential_kick,
                      sticking_dashpot,
                      stored},
                     *numbers.block);
    }
  }
  if (kind.verlet || numbers.record) {
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
  Half other[8];
  rows_of(only(touch, push.x), only(touch, push.y), only(touch, torque_i), Lanes{}, row);
  rows_of(only(touch, push.x), only(touch, push.y), only(touch, torque_j), Lanes{}, other);
  for (int k = 0; k < 8; ++k) {
    subtract(&impulses[body_of_part[group.i[k]]], row[k]);
    const std::int32_t receiver = body_of_part[group.j[k]];
    if (outward && receiver >= numbers.end) {
      put(other[k], outward++);
    } else {
      add(&impulses[receiver], other[k]);
    }
  }
}

template <class Law, PartLoopKind kind>
struct CollideParts {
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, NearParts::List& list, std::size_t block);
};

template <class Law, PartLoopKind kind>
void CollideParts<Law, kind>::run(GrainSystem& system, NearParts::List& list, std::size_t block) {
  const PartLoopNumbers numbers{system.dt(),
                                system.step - (kind.verlet ? 1 : 0),
                                system.options.integrator == GrainOptions::Integrator::corrected_verlet,
                                system.contacts.near.record,
                                &system,
                                &system.bodies.sums[block],
                                static_cast<std::int32_t>(system.bodies.blocks.end(block))};
  LaneSums sums;
  BodyImpulse *outward = list.outward.impulses.data(), *none = nullptr;
  for (std::size_t g = 0; g < list.groups.size(); ++g) {
    collide_group<Law, kind>(numbers, system.contacts.near_parts.bodies.data(), system.shapes.body_of_part.data(),
                             system.bodies.impulses.data(), list.groups[g], g < list.first_outward ? none : outward,
                             sums);
  }
  add(sums, *numbers.block);
}

template <class Law, PartLoopKind kind>
NearParts::Loop choose_part_loop() {
  return by_vector_width<CollideParts<Law, kind>, GrainSystem&, NearParts::List&, std::size_t>();
}

template <class Law, bool round>
NearParts::Loop choose_part_loop(const GrainSystem& system) {
  if (system.options.verlet()) {
    return system.friction ? choose_part_loop<Law, PartLoopKind{round, true, true}>()
                           : choose_part_loop<Law, PartLoopKind{round, false, true}>();
  }
  return system.friction ? choose_part_loop<Law, PartLoopKind{round, true, false}>()
                         : choose_part_loop<Law, PartLoopKind{round, false, false}>();
}

}  // namespace

NearParts::Loop near_part_loop(const GrainSystem& system, bool round) {
  return visit_law(system.options.law, [&]<class Law>(std::type_identity<Law>) -> NearParts::Loop {
    if constexpr (Law::kind == LawKind::force) {
      return round ? choose_part_loop<Law, true>(system) : choose_part_loop<Law, false>(system);
    } else {
      return nullptr;
    }
  });
}

}  // namespace equidem
