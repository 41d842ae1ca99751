// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contact geometry of eight pairs of parts at once.
#pragma once

#include "equidem/grains/contacts/part_geometry.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"

namespace equidem::eight {

struct Vectors {
  Lanes x, y;
};

EQUIDEM_ALWAYS_INLINE Lanes dot(const Vectors& a, const Vectors& b) {
  return a.x * b.x + a.y * b.y;
}
EQUIDEM_ALWAYS_INLINE Lanes cross(const Vectors& a, const Vectors& b) {
  return a.x * b.y - a.y * b.x;
}
EQUIDEM_ALWAYS_INLINE Vectors operator+(const Vectors& a, const Vectors& b) {
  return {a.x + b.x, a.y + b.y};
}
EQUIDEM_ALWAYS_INLINE Vectors operator-(const Vectors& a, const Vectors& b) {
  return {a.x - b.x, a.y - b.y};
}
EQUIDEM_ALWAYS_INLINE Vectors operator*(const Lanes& s, const Vectors& a) {
  return {s * a.x, s * a.y};
}
EQUIDEM_ALWAYS_INLINE Vectors perpendicular(const Vectors& a) {
  return {-a.y, a.x};
}
EQUIDEM_ALWAYS_INLINE Vectors choose(const Choice& bits, const Vectors& a, const Vectors& b) {
  return {choose(bits, a.x, b.x), choose(bits, a.y, b.y)};
}

/// Relative positions and velocities of eight pairs.
struct Standing {
  Vectors branch;            ///< between the centres of the parts
  Vectors velocity, middle;  ///< of body j relative to body i; `middle` includes half the change in the last step
  Lanes spin_i, spin_j, middle_spin_i, middle_spin_j;
  Vectors axis_i, axis_j, offset_i, offset_j;
};

/// \tparam round no ellipses in the list
template <bool round>
EQUIDEM_ALWAYS_INLINE Standing standing_of(const PartBody* bodies, const PartGroup& group) {
  Lanes way[8], own[8];
  for (int k = 0; k < 8; ++k) {
    const PartBody &i = bodies[group.i[k]], &j = bodies[group.j[k]];
    way[k] = load(&j.centre.x) - load(&i.centre.x);
    Half of_i, of_j;
    std::memcpy(&of_i, &i.spin, sizeof of_i);
    std::memcpy(&of_j, &j.spin, sizeof of_j);
    own[k] = __builtin_shufflevector(of_i, of_j, 0, 1, 2, 3, 4, 5, 6, 7);
  }
  transpose(way);
  transpose(own);
  Standing s{{way[0], way[1]}, {way[2], way[3]}, {way[4], way[5]}, own[0], own[4], own[1], own[5], {}, {},
             {own[2], own[3]}, {own[6], own[7]}};
  if constexpr (!round) {
    const auto is_ellipse = [&](PartGroup::Column a, PartGroup::Column b) {
      return negative(load(group.numbers[b]) - load(group.numbers[a]));
    };
    const Choice ellipse_i = is_ellipse(PartGroup::a_i, PartGroup::b_i);
    const Choice ellipse_j = is_ellipse(PartGroup::a_j, PartGroup::b_j);
    const Vectors any_axis{all(1), Lanes{}}, none{Lanes{}, Lanes{}};
    s.axis_i = choose(ellipse_i, s.offset_i, any_axis);
    s.axis_j = choose(ellipse_j, s.offset_j, any_axis);
    s.offset_i = choose(ellipse_i, none, s.offset_i);
    s.offset_j = choose(ellipse_j, none, s.offset_j);
  }
  return s;
}

/// PartGeometry, and which lanes touch.
struct GeometryLanes {
  Choice touch;
  Lanes overlap;
  Vectors normal;
  Vectors arm_i, arm_j;
  Lanes sunk_i, sunk_j;
};

EQUIDEM_ALWAYS_INLINE GeometryLanes geometry_of_round_parts(const PartGroup& group, const Standing& s,
                                                            const Choice& used) {
  const Lanes square = dot(s.branch, s.branch), distance = square_root(square);
  const Lanes overlap = load(group.numbers[PartGroup::reach]) - distance;
  const Choice distinct = square > 0;
  const Lanes inverse = distance * (1 / square);  // the division is independent of the root
  const Vectors normal{distinct ? s.branch.x * inverse : all(1), distinct ? s.branch.y * inverse : Lanes{}};
  const Lanes lever = load(group.numbers[PartGroup::share]) * distance, rest = distance - lever;
  return {used & negative(Lanes{} - overlap),
          overlap,
          normal,
          s.offset_i + lever * normal,
          s.offset_j - rest * normal,
          load(group.numbers[PartGroup::a_i]) - lever,
          load(group.numbers[PartGroup::a_j]) - rest};
}

/// support() of ellipse_contact.hpp.
struct Supports {
  Lanes reach, slope, radius, radius_slope;
};

struct Direction {
  Lanes p, q, reach;

  EQUIDEM_ALWAYS_INLINE Direction(const Lanes& a, const Lanes& b, const Vectors& axis, const Vectors& n)
      : p(dot(axis, n)), q(cross(axis, n)), reach(square_root((a * p) * (a * p) + (b * q) * (b * q))) {}
};

/// \param inverse 1/reach
EQUIDEM_ALWAYS_INLINE Supports supports(const Lanes& a, const Lanes& b, const Direction& d, const Lanes& inverse) {
  const Lanes w = a * b * inverse, slope = (b - a) * (b + a) * d.p * d.q * inverse, radius = w * w * inverse;
  return {d.reach, slope, radius, -3 * radius * slope * inverse};
}

/// The point that reaches farthest along n turned by an angle, to its second order.
EQUIDEM_ALWAYS_INLINE Vectors support_points(const Supports& s, const Vectors& n, const Lanes& turn) {
  const Lanes half = 0.5 * turn;
  return (s.reach - turn * half * s.radius) * n +
         (s.slope + turn * (s.radius + half * s.radius_slope)) * perpendicular(n);
}

/// Root t of f' - bend t - (R_i' + R_j') t²/2 = 0.
/// \param first f'/bend
EQUIDEM_ALWAYS_INLINE Lanes turn_to_top(const Lanes& first, const Supports& i, const Supports& j,
                                        const Lanes& per_bend) {
  return first - 0.5 * first * first * (i.radius_slope + j.radius_slope) * per_bend;
}

/// Input and results of lanes in which Newton's iteration is not certain to converge fast.
struct HardLanes {
  Standing standing;
  PairLanes gap, normal_x, normal_y, arm_i_x, arm_i_y, arm_j_x, arm_j_y;
};

[[gnu::noinline, gnu::cold]] inline void meet_one_by_one(const PartGroup& group, const Choice& hard, HardLanes& lanes) {
  for (int k = 0; k < 8; ++k) {
    if (hard[k] == 0) continue;
    const auto number = [&](PartGroup::Column column) { return group.numbers[column][k]; };
    const auto vector = [&](const Vectors& vectors) { return Vec2{vectors.x[k], vectors.y[k]}; };
    const EllipseContact contact = contact_of_parts(
        {number(PartGroup::a_i), number(PartGroup::b_i), vector(lanes.standing.axis_i)},
        {number(PartGroup::a_j), number(PartGroup::b_j), vector(lanes.standing.axis_j)}, vector(lanes.standing.branch),
        group.since[k] > PairGroup::apart, {number(PartGroup::normal_x), number(PartGroup::normal_y)});
    lanes.gap[k] = contact.gap;
    lanes.normal_x[k] = contact.normal.x;
    lanes.normal_y[k] = contact.normal.y;
    lanes.arm_i_x[k] = contact.arm_i.x;
    lanes.arm_i_y[k] = contact.arm_i.y;
    lanes.arm_j_x[k] = contact.arm_j.x;
    lanes.arm_j_y[k] = contact.arm_j.y;
  }
}

/// contact_of_parts() by Newton's iteration from the last normal, if it is short and certain to converge to the global
/// maximum. The result of a lane depends on that lane alone.
EQUIDEM_ALWAYS_INLINE GeometryLanes geometry_of_ellipses(PartGroup& group, const Standing& s, const Choice& used,
                                                         const Choice& alive) {
  constexpr int most_steps = 3;
  const Lanes a_i = load(group.numbers[PartGroup::a_i]), b_i = load(group.numbers[PartGroup::b_i]);
  const Lanes a_j = load(group.numbers[PartGroup::a_j]), b_j = load(group.numbers[PartGroup::b_j]);
  const Lanes arrived = load(group.numbers[PartGroup::arrived]), sharpest = load(group.numbers[PartGroup::sharpest]);
  const Vectors last{load(group.numbers[PartGroup::normal_x]), load(group.numbers[PartGroup::normal_y])};
  // renormalize: otherwise the round-off of the length accumulates over the steps
  Vectors n = choose(alive, (1.5 - 0.5 * dot(last, last)) * last, last);
  Supports of_i, of_j;
  Lanes gap, slope, per_bend, first;
  Choice done = ~used, apart{}, hard{};
  for (int step = 0;; ++step) {
    const Direction from_i(a_i, b_i, s.axis_i, n), from_j(a_j, b_j, s.axis_j, n);
    const Lanes both = 1 / (from_i.reach * from_j.reach);  // one division for two
    of_i = supports(a_i, b_i, from_i, both * from_j.reach);
    of_j = supports(a_j, b_j, from_j, both * from_i.reach);
    gap = dot(s.branch, n) - (of_i.reach + of_j.reach);
    slope = cross(n, s.branch) - (of_i.slope + of_j.slope);
    const Lanes bend = gap + (of_i.radius + of_j.radius);
    per_bend = 1 / bend;
    first = slope * per_bend;
    apart |= ~done & negative(Lanes{} - gap);
    done |= apart;
    const Choice there = negative(magnitude(slope) - arrived * bend);
    const Choice highest = negative(-gap - sharpest);
    if (step == 0) hard = ~done & (~alive | ~negative(Lanes{} - dot(last, s.branch)));
    done |= hard;
    const Choice found = ~done & there & highest;
    const Lanes square = first * first;
    hard |= ~done & ~found & (there | ~negative(square - 1e-6) | ~negative(Lanes{} - bend));
    done |= found | hard;
    if (!any(~done)) break;
    if (step + 1 == most_steps) {
      hard |= ~done;
      break;
    }
    // finished lanes stay unchanged; the step has third order
    const Lanes turn = turn_to_top(first, of_i, of_j, per_bend), turned = turn * turn;
    const Lanes length = 1 - turned * (0.5 - 0.375 * turned);
    n = choose(done, n, length * (n + turn * perpendicular(n)));
  }
  const Lanes turn = turn_to_top(first, of_i, of_j, per_bend);
  GeometryLanes result;
  gap = choose(apart, gap, gap + 0.5 * first * slope);
  Vectors normal = choose(apart, n, (1 - 0.5 * turn * turn) * n + turn * perpendicular(n));
  Vectors to_i = support_points(of_i, n, turn), to_j = Vectors{} - support_points(of_j, n, turn);
  if (any(hard)) {
    HardLanes lanes;
    lanes.standing = s;
    store(gap, lanes.gap);
    store(normal.x, lanes.normal_x);
    store(normal.y, lanes.normal_y);
    store(to_i.x, lanes.arm_i_x);
    store(to_i.y, lanes.arm_i_y);
    store(to_j.x, lanes.arm_j_x);
    store(to_j.y, lanes.arm_j_y);
    meet_one_by_one(group, hard, lanes);
    gap = load(lanes.gap);
    normal = {load(lanes.normal_x), load(lanes.normal_y)};
    to_i = {load(lanes.arm_i_x), load(lanes.arm_i_y)};
    to_j = {load(lanes.arm_j_x), load(lanes.arm_j_y)};
  }
  // keep earlier separating directions
  const Choice renew = alive | hard;
  store(choose(renew, normal.x, last.x), group.numbers[PartGroup::normal_x]);
  store(choose(renew, normal.y, last.y), group.numbers[PartGroup::normal_y]);
  result.touch = used & negative(gap);
  result.overlap = -gap;
  result.normal = normal;
  result.sunk_i = load(group.numbers[PartGroup::share]) * result.overlap;
  result.sunk_j = result.overlap - result.sunk_i;
  result.arm_i = s.offset_i + to_i - result.sunk_i * normal;
  result.arm_j = s.offset_j + to_j + result.sunk_j * normal;
  return result;
}

}  // namespace equidem::eight
