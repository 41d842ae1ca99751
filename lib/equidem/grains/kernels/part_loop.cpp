// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/contact/laws/visit.hpp"
#include "equidem/core/simd.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/part_lanes.hpp"
#include "equidem/grains/kernels/slide_lanes.hpp"

namespace equidem {
namespace {

// These members are loaded as one row.
static_assert(offsetof(PartBody, middle_velocity) == 2 * sizeof(Vec2) &&
              offsetof(PartBody, turned) - offsetof(PartBody, spin) == 2 * sizeof(double));

using namespace eight;

struct PartLoopKind {
  bool round = false, friction = false, verlet = false;
  bool equal = false;  ///< with friction, by NearParts::law
};

template <class Lanes>
struct PartLoopNumbers {
  LawLanes<Lanes> law;  ///< where equal
  double dt = 0;
  std::int64_t now = 0;  ///< the step that is being made, as PairGroup::since
  bool record = false;
  BlockSums* block = nullptr;
  std::int32_t end = 0;  ///< of the bodies of the block
};

template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes closing_of(const Standing<Lanes>& s, const Vectors<Lanes>& n, const Vectors<Lanes>& arm_i,
                                       const Vectors<Lanes>& arm_j) {
  return -(dot(s.velocity, n) + (s.spin_j * cross(arm_j, n) - s.spin_i * cross(arm_i, n)));
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes slip_of(const Standing<Lanes>& s, const Vectors<Lanes>& n, const Vectors<Lanes>& arm_i,
                                    const Vectors<Lanes>& arm_j) {
  return cross(n, s.velocity) + (s.spin_j * dot(arm_j, n) - s.spin_i * dot(arm_i, n));
}

template <PartLoopKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE LawLanes<Lanes> law_of(const PartLoopNumbers<Lanes>& numbers, const PartGroup& group) {
  if constexpr (kind.equal) {
    return numbers.law;
  } else {
    const auto spring = column<Lanes>(group, PartGroup::tangential_stiffness);
    return law_lanes(column<Lanes>(group, PartGroup::stiffness), column<Lanes>(group, PartGroup::least),
                     column<Lanes>(group, PartGroup::friction), spring,
                     1 / choose(negative(Lanes{} - spring), spring, all<Lanes>(1)), numbers.dt);
  }
}

/// \tparam some the group has bodies behind the block
/// \param[in,out] outward next place for the impulse on such a body
template <bool some, class Numbers>
EQUIDEM_ALWAYS_INLINE void give(const PartGroup& group, const Numbers (&on_i)[lanes_of_pairs],
                                const Numbers (&on_j)[lanes_of_pairs], const std::int32_t* body_of_part,
                                std::int32_t end, BodyImpulse* impulses, BodyImpulse*& outward) {
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    subtract(&impulses[body_of_part[group.i[k]]], on_i[k]);
    const std::int32_t receiver = body_of_part[group.j[k]];
    if (some && receiver >= end) {
      store(on_j[k], outward++);
    } else {
      add(&impulses[receiver], on_j[k]);
    }
  }
}

/// \param[in,out] outward next place for the impulse on a body behind the block; null: no body of the group is there
template <class Law, PartLoopKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE void collide_group(const PartLoopNumbers<Lanes>& numbers, const PartBody* bodies,
                                         const std::int32_t* body_of_part, BodyImpulse* impulses, PartGroup& group,
                                         BodyImpulse*& outward, LaneSums<Lanes>& sums) {
  const double dt = numbers.dt;
  const auto since = load<Bits<Lanes>>(group.since);
  const Bits<Lanes> used = ~((since - PairGroup::apart) >> 63), alive = ~(since >> 63);
  const Standing<Lanes> s = standing_of<kind.round, Lanes>(bodies, group);
  const Vectors<Lanes> normal_before{column<Lanes>(group, PartGroup::normal_x),
                                     column<Lanes>(group, PartGroup::normal_y)};
  GeometryLanes<Lanes> at;
  if constexpr (kind.round) {
    at = geometry_of_round_parts(group, s, used);
  } else {
    at = geometry_of_ellipses(group, s, used, alive);
  }
  const Bits<Lanes> touch = at.touch, begun = touch & ~alive, ended = alive & ~touch;
  const bool changes = any(touch ^ alive);
  if (changes) {
    store(choose(begun, all<Bits<Lanes>>(numbers.now), choose(ended, all<Bits<Lanes>>(PairGroup::apart), since)),
          group.since);
    sums.begun -= begun;
  } else if (!any(touch)) {
    for (std::size_t k = 0; outward && k < lanes_of_pairs; ++k) {
      if (body_of_part[group.j[k]] >= numbers.end) *outward++ = {};
    }
    return;
  }
  sums.evaluations -= touch;

  const Vectors<Lanes> n = at.normal, t = perpendicular(n);
  const Lanes across_i = cross(at.arm_i, n), across_j = cross(at.arm_j, n);
  const Lanes closing = -(dot(s.velocity, n) + (s.spin_j * across_j - s.spin_i * across_i));
  const auto inverse_mass = column<Lanes>(group, PartGroup::inverse_mass);
  const auto turning_i = column<Lanes>(group, PartGroup::inverse_moment_i);
  const auto turning_j = column<Lanes>(group, PartGroup::inverse_moment_j);
  const LawLanes<Lanes> law = law_of<kind>(numbers, group);
  const Lanes dashpot = dt * column<Lanes>(group, PartGroup::dashpot);
  const Lanes deep = only(touch, at.overlap);
  const Lanes elastic = Law::spring(law.stiffness, deep), drag = Law::dashpot(dashpot, deep) * closing;
  const Lanes impulse = only(touch, larger(law.least, elastic + drag));  // in this order a NaN persists
  const auto impulse_before = column<Lanes>(group, PartGroup::impulse);
  store(impulse, group.numbers[PartGroup::impulse]);
  Lanes normal_loss, mean_closing, deep_before, elastic_before;
  Vectors<Lanes> arm_i_before, arm_j_before;
  if constexpr (kind.verlet) {
    // over the drift, from the places at both ends of it; the dashpot gives half of the kicks before and after it each
    arm_i_before = {column<Lanes>(group, PartGroup::arm_i_x), column<Lanes>(group, PartGroup::arm_i_y)};
    arm_j_before = {column<Lanes>(group, PartGroup::arm_j_x), column<Lanes>(group, PartGroup::arm_j_y)};
    mean_closing = choose(begun, closing, closing_of(s, normal_before, arm_i_before, arm_j_before));
    mean_closing = choose(ended, mean_closing, 0.5 * (closing + mean_closing));
    deep_before = larger(column<Lanes>(group, PartGroup::overlap), Lanes{});
    elastic_before = Law::spring(law.stiffness, deep_before);
    normal_loss = only(touch & alive, 0.5 * mean_closing * ((impulse_before - elastic_before) + (impulse - elastic)));
    if (changes) [[unlikely]]
      normal_loss += normal_loss_at_ends<Law>(begun, ended, mean_closing, impulse - elastic, impulse_before,
                                              elastic_before, deep_before, dt);
  } else {
    // of the mean over the step the part of this contact is known, not only that of the last step
    const Lanes mobility = inverse_mass + across_i * across_i * turning_i + across_j * across_j * turning_j;
    mean_closing = 0.5 * mobility * (impulse_before - impulse) -
                   (dot(s.middle, n) + (s.middle_spin_j * across_j - s.middle_spin_i * across_i));
    normal_loss = only(touch, (impulse - elastic) * mean_closing);
  }
  sums.deepest = larger(deep, sums.deepest);
  Vectors<Lanes> push = impulse * n;
  Lanes torque_i = impulse * across_i, torque_j = impulse * across_j;
  if constexpr (kind.friction) {
    const Lanes along_i = dot(at.arm_i, n), along_j = dot(at.arm_j, n);
    const Lanes rim_i = along_i + at.sunk_i, rim_j = along_j - at.sunk_j;
    const Lanes at_rim = inverse_mass + rim_i * rim_i * turning_i + rim_j * rim_j * turning_j;
    const Lanes slip_dashpot = dt * column<Lanes>(group, PartGroup::tangential_damping) * square_root(1 / at_rim);
    const auto tangential_before = column<Lanes>(group, PartGroup::tangential_impulse);
    const Lanes yield = law.friction * larger(impulse, Lanes{});
    const auto stretch = column<Lanes>(group, PartGroup::stretch);
    Lanes velocity, mobility{}, mean_slip{};
    if constexpr (kind.verlet) {
      velocity = dot(s.velocity, t) + (s.spin_j * along_j - s.spin_i * along_i);
      const Bits<Lanes> first = numbers.now == 0 ? touch : begun;  // no place before is known
      mean_slip = choose(first, velocity, slip_of(s, normal_before, arm_i_before, arm_j_before));
      mean_slip = choose(ended, mean_slip, 0.5 * (velocity + mean_slip));
    } else {
      mobility = 0.5 * (inverse_mass + along_i * along_i * turning_i + along_j * along_j * turning_j);
      // without this contact's own part in it
      velocity =
          dot(s.middle, t) + (s.middle_spin_j * along_j - s.middle_spin_i * along_i) - mobility * tangential_before;
    }
    Tangent<Lanes> tangent = slide<kind.verlet, kind.equal>(law, slip_dashpot, stretch, velocity, mean_slip, mobility,
                                                            tangential_before, yield, dt);
    const Lanes tangential = only(touch, -tangent.impulse);
    store(only(touch, tangent.stretch), group.numbers[PartGroup::stretch]);
    store(tangential, group.numbers[PartGroup::tangential_impulse]);
    const Bits<Lanes> lasting = kind.verlet ? touch & alive : touch;
    tangent.slip_loss = only(lasting, tangent.slip_loss);
    tangent.dashpot_loss = only(lasting, tangent.dashpot_loss);
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
    add_losses(normal_loss, tangent.slip_loss, tangent.dashpot_loss, sums);
    push = push + tangential * t;
    torque_i += tangential * along_i;
    torque_j += tangential * along_j;
  } else {
    store(Lanes{}, group.numbers[PartGroup::tangential_impulse]);  // the friction of an earlier stage may have left one
    add_losses(normal_loss, sums);
  }
  if (kind.verlet || numbers.record) {
    store(at.overlap, group.numbers[PartGroup::overlap]);
    store(closing, group.numbers[PartGroup::closing]);
    store(at.arm_i.x, group.numbers[PartGroup::arm_i_x]);
    store(at.arm_i.y, group.numbers[PartGroup::arm_i_y]);
    store(at.arm_j.x, group.numbers[PartGroup::arm_j_x]);
    store(at.arm_j.y, group.numbers[PartGroup::arm_j_y]);
  }
  if (kind.round && (kind.verlet || numbers.record)) {
    store(n.x, group.numbers[PartGroup::normal_x]);
    store(n.y, group.numbers[PartGroup::normal_y]);
  }
  Row<Lanes> on_i[lanes_of_pairs], on_j[lanes_of_pairs];
  rows_of(only(touch, push.x), only(touch, push.y), only(touch, torque_i), Lanes{}, on_i);
  rows_of(only(touch, push.x), only(touch, push.y), only(touch, torque_j), Lanes{}, on_j);
  if (outward) {
    give<true>(group, on_i, on_j, body_of_part, numbers.end, impulses, outward);
  } else {
    give<false>(group, on_i, on_j, body_of_part, numbers.end, impulses, outward);
  }
}

template <class Law, PartLoopKind kind>
struct CollideParts {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, NearParts::List& list, std::size_t block);
};

template <class Law, PartLoopKind kind>
template <class Lanes>
void CollideParts<Law, kind>::run(GrainSystem& system, NearParts::List& list, std::size_t block) {
  const PairLaw law = system.contacts.near_parts.law.value_or(PairLaw{});
  const PartLoopNumbers<Lanes> numbers{
      law_lanes(all<Lanes>(law.stiffness), all<Lanes>(law.least), all<Lanes>(law.friction),
                all<Lanes>(law.tangential_stiffness), all<Lanes>(1 / law.tangential_stiffness), system.dt()),
      system.dt(),
      system.step + (kind.verlet ? 0 : 1),
      system.contacts.near.record,
      &system.bodies.sums[block],
      static_cast<std::int32_t>(system.bodies.blocks.end(block))};
  LaneSums<Lanes> sums;
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
  if (system.friction && system.contacts.near_parts.law) {
    return system.options.verlet() ? choose_part_loop<Law, PartLoopKind{round, true, true, true}>()
                                   : choose_part_loop<Law, PartLoopKind{round, true, false, true}>();
  }
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
