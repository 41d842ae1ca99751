// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contact geometry of eight pairs of parts at once.
#pragma once

#include "equidem/core/simd.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/respond.hpp"

namespace equidem::eight {

template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes dot(const Vectors<Lanes>& a, const Vectors<Lanes>& b) {
  return a.x * b.x + a.y * b.y;
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes cross(const Vectors<Lanes>& a, const Vectors<Lanes>& b) {
  return a.x * b.y - a.y * b.x;
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Vectors<Lanes> operator+(const Vectors<Lanes>& a, const Vectors<Lanes>& b) {
  return {a.x + b.x, a.y + b.y};
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Vectors<Lanes> operator-(const Vectors<Lanes>& a, const Vectors<Lanes>& b) {
  return {a.x - b.x, a.y - b.y};
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Vectors<Lanes> operator-(const Vectors<Lanes>& a) {
  return {Lanes{} - a.x, Lanes{} - a.y};
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Vectors<Lanes> operator*(const Lanes& s, const Vectors<Lanes>& a) {
  return {s * a.x, s * a.y};
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Vectors<Lanes> perpendicular(const Vectors<Lanes>& a) {
  return {-a.y, a.x};
}
using simd::choose;
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Vectors<Lanes> choose(const Bits<Lanes>& choice, const Vectors<Lanes>& a,
                                            const Vectors<Lanes>& b) {
  return {choose(choice, a.x, b.x), choose(choice, a.y, b.y)};
}

/// Relative positions and velocities of eight pairs.
template <class Lanes>
struct Standing {
  Vectors<Lanes> branch;            ///< between the centres of the parts
  Vectors<Lanes> velocity, middle;  ///< of body j relative to body i; `middle` includes half the last change
  Lanes spin_i, spin_j, middle_spin_i, middle_spin_j;
  Vectors<Lanes> axis_i, axis_j, offset_i, offset_j;
};

/// \tparam round no ellipses in the list
template <bool round, class Lanes>
EQUIDEM_ALWAYS_INLINE Standing<Lanes> standing_of(const PartBody* bodies, const ContactRows& of,
                                                  const CellShifts& shifts) {
  Lanes way[lanes_of_pairs];
  Row<Lanes> of_i[lanes_of_pairs], of_j[lanes_of_pairs];
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    const PartBody &i = bodies[of.group.i[k]], &j = bodies[of.group.j[k]];
    way[k] = load<Lanes>(&j.centre.x) - load<Lanes>(&i.centre.x);
    of_i[k] = load<Row<Lanes>>(&i.spin);
    of_j[k] = load<Row<Lanes>>(&j.spin);
  }
  transpose(way);
  Standing<Lanes> s{};
  s.branch = {way[0], way[1]};
  s.velocity = {way[2], way[3]};
  s.middle = {way[4], way[5]};
  if (of.images != nullptr) {
    s.branch = s.branch + shift_of<Lanes>(shifts.places, *of.images);
    s.velocity = s.velocity + shift_of<Lanes>(shifts.velocities, *of.images);
  }
  columns_of(of_i, s.spin_i, s.middle_spin_i, s.offset_i.x, s.offset_i.y);
  columns_of(of_j, s.spin_j, s.middle_spin_j, s.offset_j.x, s.offset_j.y);
  if constexpr (!round) {
    const Bits<Lanes> ellipse_i = negative(load<Lanes>(of.shapes.b_i) - load<Lanes>(of.shapes.a_i));
    const Bits<Lanes> ellipse_j = negative(load<Lanes>(of.shapes.b_j) - load<Lanes>(of.shapes.a_j));
    const Vectors<Lanes> any_axis{all<Lanes>(1), Lanes{}}, none{};
    s.axis_i = choose(ellipse_i, s.offset_i, any_axis);
    s.axis_j = choose(ellipse_j, s.offset_j, any_axis);
    s.offset_i = choose(ellipse_i, none, s.offset_i);
    s.offset_j = choose(ellipse_j, none, s.offset_j);
  }
  return s;
}

/// PartGeometry, and which lanes touch.
template <class Lanes>
struct GeometryLanes {
  Bits<Lanes> touch;
  Lanes overlap;
  Vectors<Lanes> normal;
  Vectors<Lanes> arm_i, arm_j;
  Lanes sunk_i, sunk_j;
};

template <class Lanes>
EQUIDEM_ALWAYS_INLINE GeometryLanes<Lanes> geometry_of_round_parts(const ContactRows& of, const Standing<Lanes>& s,
                                                                   const Bits<Lanes>& used) {
  Lanes bx = s.branch.x;
  const Lanes& by = s.branch.y;
  const Lanes square = square_of_branch(bx, by), distance = square_root(square);
  const Lanes overlap = load<Lanes>(of.group.reach) - distance;
  const Lanes inverse = distance * (1 / square);  // the division is independent of the root
  const Vectors<Lanes> normal{bx * inverse, by * inverse};
  const Lanes lever = load<Lanes>(of.shapes.share) * distance, rest = distance - lever;
  return {used & negative(Lanes{} - overlap),
          overlap,
          normal,
          s.offset_i + lever * normal,
          s.offset_j - rest * normal,
          load<Lanes>(of.shapes.a_i) - lever,
          load<Lanes>(of.shapes.a_j) - rest};
}

/// support() of geometry/shapes.hpp.
template <class Lanes>
struct Supports {
  Lanes reach, slope, radius, radius_slope;
};

template <class Lanes>
struct Direction {
  Lanes p, q, reach;
};

template <class Lanes>
EQUIDEM_ALWAYS_INLINE Direction<Lanes> direction_of(const Lanes& a, const Lanes& b, const Vectors<Lanes>& axis,
                                                    const Vectors<Lanes>& n) {
  const Lanes p = dot(axis, n), q = cross(axis, n);
  return {p, q, square_root((a * p) * (a * p) + (b * q) * (b * q))};
}

/// \param inverse 1/reach
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Supports<Lanes> supports(const Lanes& a, const Lanes& b, const Direction<Lanes>& d,
                                               const Lanes& inverse) {
  const Lanes w = a * b * inverse, slope = (b - a) * (b + a) * d.p * d.q * inverse, radius = w * w * inverse;
  return {d.reach, slope, radius, -3 * radius * slope * inverse};
}

/// The point that reaches farthest along n turned by an angle, to its second order.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Vectors<Lanes> support_points(const Supports<Lanes>& s, const Vectors<Lanes>& n,
                                                    const Lanes& turn) {
  const Lanes half = 0.5 * turn;
  return (s.reach - turn * half * s.radius) * n +
         (s.slope + turn * (s.radius + half * s.radius_slope)) * perpendicular(n);
}

/// Root t of f' - bend t - (R_i' + R_j') t²/2 = 0.
/// \param first f'/bend
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes turn_to_top(const Lanes& first, const Supports<Lanes>& i, const Supports<Lanes>& j,
                                        const Lanes& per_bend) {
  return first - 0.5 * first * first * (i.radius_slope + j.radius_slope) * per_bend;
}

/// Lanes in which Newton's iteration is not certain to converge fast, and what they meet at.
struct HardLanes {
  std::int64_t hard[lanes_of_pairs];  ///< 0: not so
  PairLanes branch_x, branch_y, axis_i_x, axis_i_y, axis_j_x, axis_j_y;
  PairLanes gap, normal_x, normal_y, arm_i_x, arm_i_y, arm_j_x, arm_j_y;

  void set(std::size_t k, const EllipseContact& contact) {
    gap[k] = contact.gap;
    normal_x[k] = contact.normal.x, normal_y[k] = contact.normal.y;
    arm_i_x[k] = contact.arm_i.x, arm_i_y[k] = contact.arm_i.y;
    arm_j_x[k] = contact.arm_j.x, arm_j_y[k] = contact.arm_j.y;
  }
};

[[gnu::noinline, gnu::cold]] inline void meet_one_by_one(const ContactRows& of, HardLanes& lanes) {
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    if (lanes.hard[k] == 0) continue;
    const EllipseContact contact = contact_of_parts(
        {of.shapes.a_i[k], of.shapes.b_i[k], {lanes.axis_i_x[k], lanes.axis_i_y[k]}},
        {of.shapes.a_j[k], of.shapes.b_j[k], {lanes.axis_j_x[k], lanes.axis_j_y[k]}},
        {lanes.branch_x[k], lanes.branch_y[k]}, of.group.since[k] > ContactGroup::apart,
        {of.records.normal_x[k], of.records.normal_y[k]}, of.effects == nullptr ? 0 : of.effects->range[k]);
    lanes.set(k, contact);
  }
}

[[gnu::noinline]] inline void meet_by_enlarged_ellipse(const ContactRows& of, HardLanes& lanes) {
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    EllipseContact contact;
    contact.gap = 1;
    if (lanes.hard[k] != 0)
      contact =
          contact_by_enlarged_ellipse({of.shapes.a_i[k], of.shapes.b_i[k], {lanes.axis_i_x[k], lanes.axis_i_y[k]}},
                                      {of.shapes.a_j[k], of.shapes.b_j[k], {lanes.axis_j_x[k], lanes.axis_j_y[k]}},
                                      {lanes.branch_x[k], lanes.branch_y[k]});
    lanes.set(k, contact);
  }
}

template <class Lanes>
EQUIDEM_ALWAYS_INLINE void store_standing(const Standing<Lanes>& s, const Bits<Lanes>& chosen, HardLanes& lanes) {
  store(chosen, lanes.hard);
  store(s.branch.x, lanes.branch_x);
  store(s.branch.y, lanes.branch_y);
  store(s.axis_i.x, lanes.axis_i_x);
  store(s.axis_i.y, lanes.axis_i_y);
  store(s.axis_j.x, lanes.axis_j_x);
  store(s.axis_j.y, lanes.axis_j_y);
}

/// Meet one by one where it is hard.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void meet_hard(const ContactRows& of, const Standing<Lanes>& s, const Bits<Lanes>& hard,
                                     Lanes& gap, Vectors<Lanes>& normal, Vectors<Lanes>& to_i, Vectors<Lanes>& to_j) {
  HardLanes lanes;
  store_standing(s, hard, lanes);
  store(gap, lanes.gap);
  store(normal.x, lanes.normal_x);
  store(normal.y, lanes.normal_y);
  store(to_i.x, lanes.arm_i_x);
  store(to_i.y, lanes.arm_i_y);
  store(to_j.x, lanes.arm_j_x);
  store(to_j.y, lanes.arm_j_y);
  meet_one_by_one(of, lanes);
  gap = load<Lanes>(lanes.gap);
  normal = {load<Lanes>(lanes.normal_x), load<Lanes>(lanes.normal_y)};
  to_i = {load<Lanes>(lanes.arm_i_x), load<Lanes>(lanes.arm_i_y)};
  to_j = {load<Lanes>(lanes.arm_j_x), load<Lanes>(lanes.arm_j_y)};
}

/// contact_of_parts() by Newton's iteration from the last normal, if it is short and certain to converge to the global
/// maximum. The result of a lane depends on that lane alone.
/// \tparam cohesion contacts have a range
template <bool cohesion, class Lanes>
EQUIDEM_ALWAYS_INLINE GeometryLanes<Lanes> geometry_of_ellipses(const ContactRows& of, const Standing<Lanes>& s,
                                                                const Bits<Lanes>& used, const Bits<Lanes>& alive) {
  constexpr int most_steps = 3;
  const auto a_i = load<Lanes>(of.shapes.a_i), b_i = load<Lanes>(of.shapes.b_i);
  const auto a_j = load<Lanes>(of.shapes.a_j), b_j = load<Lanes>(of.shapes.b_j);
  const auto arrived = load<Lanes>(of.shapes.arrived), sharpest = load<Lanes>(of.shapes.sharpest);
  const Vectors<Lanes> last{load<Lanes>(of.records.normal_x), load<Lanes>(of.records.normal_y)};
  // renormalize: otherwise the round-off of the length accumulates over the steps
  const Lanes length_of_last = 1.5 - 0.5 * dot(last, last);
  Vectors<Lanes> n = choose(alive, length_of_last * last, last);
  Supports<Lanes> of_i, of_j;
  Lanes gap, slope, per_bend, first;
  Bits<Lanes> done = ~used, apart{}, hard{};
  for (int step = 0;; ++step) {
    const Direction<Lanes> from_i = direction_of(a_i, b_i, s.axis_i, n), from_j = direction_of(a_j, b_j, s.axis_j, n);
    const Lanes both = 1 / (from_i.reach * from_j.reach);  // one division for two
    of_i = supports(a_i, b_i, from_i, both * from_j.reach);
    of_j = supports(a_j, b_j, from_j, both * from_i.reach);
    gap = dot(s.branch, n) - (of_i.reach + of_j.reach);
    slope = cross(n, s.branch) - (of_i.slope + of_j.slope);
    const Lanes bend = gap + (of_i.radius + of_j.radius);
    per_bend = 1 / bend;
    first = slope * per_bend;
    if constexpr (cohesion) {
      apart |= ~done & negative(load<Lanes>(of.effects->range) - gap);
    } else {
      apart |= ~done & negative(Lanes{} - gap);
    }
    done |= apart;
    const Bits<Lanes> there = negative(magnitude(slope) - arrived * bend);
    const Bits<Lanes> highest = negative(-gap - sharpest);
    if (step == 0) hard = ~done & (~alive | ~negative(Lanes{} - dot(last, s.branch)));
    done |= hard;
    const Bits<Lanes> found = ~done & there & highest;
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
  const Lanes turn = turn_to_top(first, of_i, of_j, per_bend), shorter = 1 - 0.5 * turn * turn;
  GeometryLanes<Lanes> result;
  gap = choose(apart, gap, gap + 0.5 * first * slope);
  Vectors<Lanes> normal = choose(apart, n, shorter * n + turn * perpendicular(n));
  Vectors<Lanes> to_i = support_points(of_i, n, turn), to_j = -support_points(of_j, n, turn);
  if (any(hard)) meet_hard(of, s, hard, gap, normal, to_i, to_j);
  // keep earlier separating directions
  const Bits<Lanes> renew = alive | hard;
  store(choose(renew, normal.x, last.x), of.records.normal_x);
  store(choose(renew, normal.y, last.y), of.records.normal_y);
  result.touch = used & negative(gap);
  result.overlap = -gap;
  result.normal = normal;
  result.sunk_i = load<Lanes>(of.shapes.share) * result.overlap;
  result.sunk_j = result.overlap - result.sunk_i;
  result.arm_i = s.offset_i + to_i - result.sunk_i * normal;
  result.arm_j = s.offset_j + to_j + result.sunk_j * normal;
  return result;
}

/// contact_by_enlarged_ellipse() one by one; round parts meet as in geometry_of_round_parts().
template <class Lanes>
EQUIDEM_ALWAYS_INLINE GeometryLanes<Lanes> geometry_of_enlarged_ellipses(const ContactRows& of,
                                                                         const Standing<Lanes>& s,
                                                                         const Bits<Lanes>& used) {
  HardLanes lanes;
  store_standing(s, used, lanes);
  meet_by_enlarged_ellipse(of, lanes);
  GeometryLanes<Lanes> result;
  result.overlap = -load<Lanes>(lanes.gap);
  result.touch = used & negative(Lanes{} - result.overlap);
  result.normal = {load<Lanes>(lanes.normal_x), load<Lanes>(lanes.normal_y)};
  result.arm_i = s.offset_i + Vectors<Lanes>{load<Lanes>(lanes.arm_i_x), load<Lanes>(lanes.arm_i_y)};
  result.arm_j = s.offset_j + Vectors<Lanes>{load<Lanes>(lanes.arm_j_x), load<Lanes>(lanes.arm_j_y)};
  result.sunk_i = result.sunk_j = Lanes{};
  return result;
}

}  // namespace equidem::eight
