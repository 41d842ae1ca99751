// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts of parts of bodies, and of bodies with walls, by a force law, eight at a time.
///
/// An impulse p at the contact point exerts arm x p on both bodies; velocities are those of the material points there.
/// Stiffness and dashpot are those of a central impact: c = 2 zeta sqrt(m k) with 1/m = 1/m_i + 1/m_j, without the arms
/// (Sukegawa 2010, (2.27)). An eccentric impact has the smaller mass m', 1/m' = 1/m + (arm_i x n)²/I_i + (arm_j x
/// n)²/I_j: its duration is shorter by sqrt(m'/m), and zeta' = zeta sqrt(m/m') makes its restitution smaller than
/// prescribed. The tangential dashpot is 2 zeta_T sqrt(m_T kT) with the tangential mass of the present arms.
#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/core/simd.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/part_lanes.hpp"
#include "equidem/grains/kernels/respond.hpp"

namespace equidem {
namespace {

// These members are loaded as one row.
static_assert(offsetof(PartBody, middle_velocity) == 2 * sizeof(Vec2) &&
              offsetof(PartBody, turned) - offsetof(PartBody, spin) == 2 * sizeof(double));

using namespace eight;

struct PartLoopKind {
  Between between = Between::round_parts;
  ResponseKind response;
  bool enlarged = false;  ///< ellipses by contact_by_enlarged_ellipse()
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

/// Parts of the arms along and across the normal, and the inverse of the tangential mass at the surfaces.
template <class Lanes>
struct Levers {
  Lanes across_i, across_j, along_i, along_j, at_rim;
};

template <class Lanes>
EQUIDEM_ALWAYS_INLINE Vectors<Lanes> vectors(const PairLanes& x, const PairLanes& y) {
  return {load<Lanes>(x), load<Lanes>(y)};
}

/// \param drift velocities over the drift in Verlet schemes: of walls not those at the instant
/// \param[in,out] levers of walls with across_i
template <PartLoopKind parts, class Lanes>
EQUIDEM_ALWAYS_INLINE ContactMotion<Lanes> motion_of(const ContactRows& of, const Standing<Lanes>& s,
                                                     const Standing<Lanes>& drift, const GeometryLanes<Lanes>& found,
                                                     const Vectors<Lanes>& normal_before,
                                                     const ContactChanges<Lanes>& at, Levers<Lanes>& levers) {
  constexpr ResponseKind kind = parts.response;
  const Vectors<Lanes>& n = found.normal;
  if constexpr (parts.between != Between::walls) {
    levers.across_i = cross(found.arm_i, n);
    levers.across_j = cross(found.arm_j, n);
  }
  const auto inverse_mass = 2 * load<Lanes>(of.group.half_mobility);
  const auto turning_i = load<Lanes>(of.shapes.inverse_moment_i);
  const auto turning_j = load<Lanes>(of.shapes.inverse_moment_j);
  ContactMotion<Lanes> motion;
  motion.overlap = found.overlap;
  motion.closing = -(dot(s.velocity, n) + (s.spin_j * levers.across_j - s.spin_i * levers.across_i));
  Vectors<Lanes> arm_i_before, arm_j_before;
  if constexpr (kind.verlet) {
    // over the drift, from the places at both ends of it
    arm_i_before = vectors<Lanes>(of.shapes.arm_i_x, of.shapes.arm_i_y);
    arm_j_before = vectors<Lanes>(of.shapes.arm_j_x, of.shapes.arm_j_y);
    const Lanes here = closing_of(drift, n, found.arm_i, found.arm_j);
    const Lanes there = choose(at.begun, here, closing_of(drift, normal_before, arm_i_before, arm_j_before));
    motion.mean_closing = choose(at.ended, there, 0.5 * (here + there));
    motion.overlap_before = larger(load<Lanes>(of.records.overlap), Lanes{});
  } else {
    motion.half_mobility = 0.5 * (inverse_mass + levers.across_i * levers.across_i * turning_i +
                                  levers.across_j * levers.across_j * turning_j);
    motion.middle_closing =
        -(dot(s.middle, n) + (s.middle_spin_j * levers.across_j - s.middle_spin_i * levers.across_i));
  }
  if constexpr (kind.friction) {
    const Lanes &along_i = levers.along_i = dot(found.arm_i, n), &along_j = levers.along_j = dot(found.arm_j, n);
    const Lanes rim_i = along_i + found.sunk_i, rim_j = along_j - found.sunk_j;
    levers.at_rim = inverse_mass + rim_i * rim_i * turning_i + rim_j * rim_j * turning_j;
    const Vectors<Lanes> t = perpendicular(n);
    if constexpr (kind.verlet) {
      motion.slip = dot(s.velocity, t) + (s.spin_j * along_j - s.spin_i * along_i);
      const Bits<Lanes> first = at.first ? at.touch : at.begun;  // no place before is known
      const Lanes here = slip_of(drift, n, found.arm_i, found.arm_j);
      const Lanes there = choose(first, here, slip_of(drift, normal_before, arm_i_before, arm_j_before));
      motion.mean_slip = choose(at.ended, there, 0.5 * (here + there));
    } else {
      motion.mobility = 0.5 * (inverse_mass + along_i * along_i * turning_i + along_j * along_j * turning_j);
      motion.slip = dot(s.middle, t) + (s.middle_spin_j * along_j - s.middle_spin_i * along_i);
    }
  }
  return motion;
}

/// Contacts with walls, found one by one.
struct WallLanes {
  PairLanes overlap, normal_x, normal_y, arm_x, arm_y, across;
  PairLanes u, v, spin;                    ///< of the wall relative to the body; of the body
  PairLanes other_u, other_v, other_spin;  ///< Euler: in the middle of the step; Verlet: over the drift before
};

EQUIDEM_ALWAYS_INLINE std::int32_t body_of(const std::int32_t* body_of_part, std::int32_t part) {
  return body_of_part == nullptr ? part : body_of_part[part];
}

/// Discs at lines here, all others by geometry_with_wall(). Lanes without a contact, and covered ones, are apart.
inline void measure_walls(const GrainSystem& system, const ContactRows& of, const std::int32_t* body_of_part,
                          WallLanes& found) {
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    found.overlap[k] = -std::numeric_limits<double>::max();  // beyond any range
    found.normal_x[k] = found.normal_y[k] = found.arm_x[k] = found.arm_y[k] = found.across[k] = 0;
    if (of.group.since[k] == ContactGroup::unused || of.shapes.covered[k] != 0) continue;
    const auto w = static_cast<std::size_t>(of.group.j[k]);
    const Wall& wall = system.scene.walls[w];
    if (body_of_part == nullptr && wall.shape == Wall::Shape::line) {
      const auto i = static_cast<std::size_t>(of.group.i[k]);
      const double radius = system.bodies.constants[i].radius;
      const Vec2 from = system.bodies.motions[i].position - system.walls.places[w].displacement - wall.point;
      found.overlap[k] = radius - dot(wall.normal, from);
      found.normal_x[k] = -wall.normal.x;
      found.normal_y[k] = -wall.normal.y;
      found.arm_x[k] = radius * found.normal_x[k];
      found.arm_y[k] = radius * found.normal_y[k];
      continue;
    }
    const bool touching = of.group.since[k] > ContactGroup::apart;
    const Vec2 normal{of.records.normal_x[k], of.records.normal_y[k]};
    const PartGeometry geometry = geometry_with_wall(system, of.group.i[k], w, touching ? normal : Vec2{});
    found.overlap[k] = geometry.overlap;
    found.normal_x[k] = geometry.normal.x;
    found.normal_y[k] = geometry.normal.y;
    found.arm_x[k] = geometry.arm_i.x;
    found.arm_y[k] = geometry.arm_i.y;
    found.across[k] = geometry.across_i;
  }
}

/// \tparam verlet else semi-implicit Euler
template <bool verlet>
inline void find_velocities_at_walls(const GrainSystem& system, const ContactRows& of, const std::int32_t* body_of_part,
                                     WallLanes& found) {
  const Vec2 half_fall = (0.5 * system.dt()) * system.scene.gravity;
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    const auto part = static_cast<std::size_t>(of.group.i[k]);
    const auto i = static_cast<std::size_t>(body_of(body_of_part, of.group.i[k]));
    const GrainMotion& motion = system.bodies.motions[i];
    const WallPlace& wall = system.walls.places[of.group.since[k] == ContactGroup::unused ? 0 : of.group.j[k]];
    const Vec2 velocity = wall.acting_velocity - motion.velocity;
    Vec2 other = wall.passed_velocity - motion.velocity;
    double spin = motion.spin;
    if constexpr (!verlet) {
      // all that other forces do to the velocity of the body in the step, gravity included: as in the last step
      const bool discs = body_of_part == nullptr;
      const Vec2 middle =
          discs ? system.contacts.pairs.bodies[i].middle_velocity : system.contacts.parts.bodies[part].middle_velocity;
      other = wall.acting_velocity - (middle + half_fall);
      spin = discs ? system.contacts.pairs.bodies[i].middle_rim_speed / system.bodies.constants[i].radius
                   : system.contacts.parts.bodies[part].middle_spin;
    }
    found.u[k] = velocity.x;
    found.v[k] = velocity.y;
    found.spin[k] = motion.spin;
    found.other_u[k] = other.x;
    found.other_v[k] = other.y;
    found.other_spin[k] = spin;
  }
}

/// The impulses of bodies on walls, those of a Verlet drift half of each of the kicks at its ends.
/// \param kicks on the walls, N s, and couples, N m s
template <bool verlet>
inline void push_walls(const GrainSystem& system, const ContactRows& of, const std::int32_t* body_of_part,
                       const std::int64_t (&acts)[lanes_of_pairs], const PairLanes (&kicks)[3],
                       const PairLanes (&arms)[2], BlockSums& sums) {
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    if (acts[k] == 0) continue;
    const auto i = static_cast<std::size_t>(body_of(body_of_part, of.group.i[k]));
    const Vec2 point = system.bodies.motions[i].position + Vec2{arms[0][k], arms[1][k]};
    const WallPlace& wall = system.walls.places[of.group.j[k]];
    push_wall(system, ~of.group.j[k], point, {kicks[0][k], kicks[1][k]},
              verlet ? wall.passed_velocity : wall.acting_velocity, sums.sums(), kicks[2][k]);
  }
}

/// \param[in,out] outward next place for the impulse on a body behind the block; null: no body of the group is there
template <class Law, PartLoopKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE void collide_group(const LoopNumbers<Lanes>& numbers, GrainSystem& system, const Receivers& to,
                                         const ContactRows& of, BodyImpulse*& outward, LaneSums<Lanes>& sums,
                                         BlockSums& block) {
  constexpr bool verlet = kind.response.verlet, walls = kind.between == Between::walls;
  const double dt = numbers.dt;
  const auto since = load<Bits<Lanes>>(of.group.since);
  const Bits<Lanes> used = ~((since - ContactGroup::apart) >> 63), alive = ~(since >> 63);
  const Vectors<Lanes> normal_before = vectors<Lanes>(of.records.normal_x, of.records.normal_y);
  Standing<Lanes> s, drift;
  GeometryLanes<Lanes> found;
  Levers<Lanes> levers;
  EffectLanes<Lanes> effect_lanes;
  if constexpr (kind.response.cohesion) effect_lanes.cohesion = cohesion_lanes<Lanes>(*of.effects);
  WallLanes at_walls;
  if constexpr (walls) {
    measure_walls(system, of, to.bodies, at_walls);
    found.overlap = load<Lanes>(at_walls.overlap);
    found.touch = negative(Lanes{} - found.overlap);
  } else {
    s = standing_of<kind.between == Between::round_parts, Lanes>(system.contacts.parts.bodies.data(), of,
                                                                 numbers.shifts);
    if constexpr (kind.between == Between::round_parts) {
      found = geometry_of_round_parts(of, s, used);
    } else if constexpr (kind.enlarged) {
      found = geometry_of_enlarged_ellipses(of, s, used);
    } else {
      found = geometry_of_ellipses<kind.response.cohesion>(of, s, used, alive);
    }
  }
  if constexpr (kind.response.cohesion)
    found.touch = used & negative(Lanes{} - (found.overlap + effect_lanes.cohesion.range));
  ContactChanges<Lanes> at;
  if (!begin_and_end(found.touch, numbers.now, of.group.since, at, sums)) {
    if (outward) give_nothing<true>(of.group.j, to, outward);
    return;
  }
  if constexpr (walls) {
    find_velocities_at_walls<verlet>(system, of, to.bodies, at_walls);
    const Vectors<Lanes> other{load<Lanes>(at_walls.other_u), load<Lanes>(at_walls.other_v)};
    s = Standing<Lanes>{};
    s.velocity = {load<Lanes>(at_walls.u), load<Lanes>(at_walls.v)};
    s.spin_i = load<Lanes>(at_walls.spin);
    s.middle = other;
    s.middle_spin_i = load<Lanes>(at_walls.other_spin);
    drift = s;
    drift.velocity = other;
    found.normal = {load<Lanes>(at_walls.normal_x), load<Lanes>(at_walls.normal_y)};
    found.arm_i = {load<Lanes>(at_walls.arm_x), load<Lanes>(at_walls.arm_y)};
    found.arm_j = {Lanes{}, Lanes{}};
    found.sunk_i = found.sunk_j = Lanes{};
    levers.across_i = load<Lanes>(at_walls.across);
    levers.across_j = Lanes{};
  }
  const ContactMotion<Lanes> motion = motion_of<kind>(of, s, walls ? drift : s, found, normal_before, at, levers);
  sums.deepest = larger(only(at.touch, motion.overlap), sums.deepest);
  Lanes slip_dashpot;
  if constexpr (kind.response.friction)
    slip_dashpot = dt * load<Lanes>(of.slips.dashpot) * square_root(1 / levers.at_rim);
  const ContactMemory<Lanes> before{
      load<Lanes>(of.group.impulse), load<Lanes>(of.slips.impulse), load<Lanes>(of.slips.stretch), {}};
  ContactMemory<Lanes> memory = before;
  Lanes couple_before{};
  if constexpr (kind.response.rolling) {
    const auto lever = load<Lanes>(of.effects->lever);
    const Lanes turning = kind.response.verlet ? s.spin_j - s.spin_i : s.middle_spin_j - s.middle_spin_i;
    effect_lanes.rolling = rolling_lanes(*of.effects, lever * turning, dt);
    memory.rolling = rolling_memory<Lanes>(*of.effects);
    couple_before = lever * memory.rolling.impulse;
  }
  ContactLosses<Lanes> losses{};
  respond<Law, kind.response>(law_of<kind.response>(numbers, &of.laws), load<Lanes>(of.group.dashpot), slip_dashpot,
                              motion, at, dt, effect_lanes, memory, losses);
  add_losses<kind.response>(losses, effect_lanes.rolling.lost, at.any, sums);
  const Vectors<Lanes> n = found.normal, t = perpendicular(n);
  Vectors<Lanes> push = memory.impulse * n;
  Lanes torque_i = memory.impulse * levers.across_i, torque_j = memory.impulse * levers.across_j;
  if constexpr (kind.response.friction) {
    push = push + memory.tangential * t;
    torque_i += memory.tangential * levers.along_i;
    torque_j += memory.tangential * levers.along_j;
  }
  Lanes couple{};
  if constexpr (kind.response.rolling) {
    couple = load<Lanes>(of.effects->lever) * memory.rolling.impulse;
    torque_i += couple;
    torque_j += couple;
    store(memory.rolling, *of.effects);
  }
  push = {only(at.touch, push.x), only(at.touch, push.y)};
  if (!walls && of.images != nullptr) add_on_images(push.x, push.y, *of.images, sums);
  if constexpr (walls) {
    Vectors<Lanes> kicks = push, arms = found.arm_i;
    Bits<Lanes> acts = at.touch;
    if constexpr (verlet) {
      const Vectors<Lanes> kicks_before =
          before.impulse * normal_before + before.tangential * perpendicular(normal_before);
      acts = at.touch | at.ended;
      kicks = {0.5 * (kicks.x + only(at.alive, kicks_before.x)), 0.5 * (kicks.y + only(at.alive, kicks_before.y))};
      couple = 0.5 * (couple + only(at.alive, couple_before));
      arms = choose(at.ended, vectors<Lanes>(of.shapes.arm_i_x, of.shapes.arm_i_y), arms);
    }
    std::int64_t which[lanes_of_pairs];
    PairLanes on_walls[3], to_points[2];
    store(acts, which);
    store(kicks.x, on_walls[0]);
    store(kicks.y, on_walls[1]);
    store(couple, on_walls[2]);
    store(arms.x, to_points[0]);
    store(arms.y, to_points[1]);
    push_walls<verlet>(system, of, to.bodies, which, on_walls, to_points, block);
  }
  store(memory.impulse, of.group.impulse);
  store(memory.tangential, of.slips.impulse);
  if constexpr (kind.response.friction) store(memory.stretch, of.slips.stretch);
  if (walls || verlet || numbers.record) {
    store(found.overlap, of.records.overlap);
    store(motion.closing, of.records.closing);
    store(found.arm_i.x, of.shapes.arm_i_x);
    store(found.arm_i.y, of.shapes.arm_i_y);
    store(found.arm_j.x, of.shapes.arm_j_x);
    store(found.arm_j.y, of.shapes.arm_j_y);
    if constexpr (kind.between != Between::ellipses || kind.enlarged) {
      store(n.x, of.records.normal_x);
      store(n.y, of.records.normal_y);
    }
  }
  Row<Lanes> on_i[lanes_of_pairs];
  rows_of(push.x, push.y, only(at.touch, torque_i), Lanes{}, on_i);
  if constexpr (walls) {
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) subtract(&to.impulses[to.of(of.group.i[k])], on_i[k]);
  } else {
    Row<Lanes> on_j[lanes_of_pairs];
    rows_of(push.x, push.y, only(at.touch, torque_j), Lanes{}, on_j);
    const auto of_j = [&](std::size_t k) { return on_j[k]; };
    if (outward) {
      scatter<true>(of.group.i, of.group.j, to, outward, on_i, of_j);
    } else {
      scatter<false>(of.group.i, of.group.j, to, outward, on_i, of_j);
    }
  }
}

template <class Law, PartLoopKind kind>
struct CollideParts {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, NearList& list, std::size_t block);
};

template <class Law, PartLoopKind kind>
template <class Lanes>
void CollideParts<Law, kind>::run(GrainSystem& system, NearList& list, std::size_t block) {
  const LoopNumbers<Lanes> numbers(system);
  LaneSums<Lanes> sums;
  const bool shapes = !system.shapes.parts.empty();
  const Receivers to{system.bodies.impulses.data(), static_cast<std::int32_t>(system.bodies.blocks.end(block)),
                     shapes ? system.shapes.body_of_part.data() : nullptr};
  BodyImpulse *outward = list.outward.impulses.data(), *none = nullptr;
  for (std::size_t g = 0; g < list.groups.size(); ++g) {
    collide_group<Law, kind>(numbers, system, to, list.rows(g), g < list.first_outward ? none : outward, sums,
                             system.bodies.sums[block]);
  }
  add(sums, system.bodies.sums[block]);
}

template <class Law, PartLoopKind kind>
NearLists::Loop choose_part_loop() {
  return by_vector_width<CollideParts<Law, kind>, GrainSystem&, NearList&, std::size_t>();
}

template <class Law, Between between, bool verlet, bool enlarged>
NearLists::Loop choose_part_loop(const GrainSystem& system) {
  if constexpr (!enlarged)
    if (system.has_effects()) return choose_part_loop<Law, PartLoopKind{between, with_effects<verlet>}>();
  if constexpr (!enlarged && between != Between::walls) {
    if (system.friction && system.contacts.law)
      return choose_part_loop<Law, PartLoopKind{between, {true, verlet, true, false}}>();
  }
  return system.friction ? choose_part_loop<Law, PartLoopKind{between, {true, verlet, false, false}, enlarged}>()
                         : choose_part_loop<Law, PartLoopKind{between, {false, verlet, false, false}, enlarged}>();
}

template <Between between, bool enlarged = false>
NearLists::Loop loop_for(const GrainSystem& system) {
  return visit_law(system.options.law, [&]<class Law>(std::type_identity<Law>) -> NearLists::Loop {
    if constexpr (Law::facts.kind == LawKind::force) {
      return system.options.verlet() ? choose_part_loop<Law, between, true, enlarged>(system)
                                     : choose_part_loop<Law, between, false, enlarged>(system);
    } else {
      return nullptr;
    }
  });
}

}  // namespace

NearLists::Loop loop_of_parts(const GrainSystem& system, Between between) {
  if (between == Between::walls) return loop_for<Between::walls>(system);
  if (between == Between::round_parts) return loop_for<Between::round_parts>(system);
  return system.options.ellipse_law == GrainOptions::EllipseLaw::exact ? loop_for<Between::ellipses>(system)
                                                                       : loop_for<Between::ellipses, true>(system);
}

}  // namespace equidem
