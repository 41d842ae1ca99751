// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts of two shapes, or of a shape and a line or a segment: closest points and common normal.
///
/// The contact of two ellipses is exact:
///
/// gap = max over unit vectors n of f(n) = branch . n - h_i(n) - h_j(n), h the support functions; the normal is the n
/// that attains it, the contact points are the points of the ellipses that reach farthest along n and -n. Apart, the
/// gap is the distance and they are the closest points; overlapping, -gap is the shortest way along which one can be
/// moved out of the other, and gap and normal stay continuous through touching. For discs it is the disc law.
///
/// f'' = -(f + R) with R the sum of the radii of curvature. As long as -f is below the sum of the sharpest radii,
/// b_i²/a_i + b_j²/a_j, a maximum is the only one that deep (its ellipses shrunk by discs of these radii are apart);
/// deeper, up to four are compared. There the normal jumps where two separating displacements are equally short; either
/// is returned.
///
/// The approximate contact of two ellipses after Sukegawa (2010), (4.1)-(4.49).
///
/// The plane is stretched until ellipse j is a unit circle. The image of ellipse i with both half-axes longer by one,
/// a' + 1 and b' + 1, then stands for all places where the circle would touch it, and the ellipses count as touching
/// where it holds the circle's centre. It lies within the true curve of such places: contacts are never invented, but
/// shallow ones are missed, and which depends on the aspects. The normal is that of ellipse i near the contact point:
/// not the common one, even at first touch. Exact for discs.
#pragma once

#include <cmath>
#include <cstddef>

#include "equidem/geometry/shapes.hpp"

namespace equidem {

/// Signed distance of two ellipses along n: branch . n - h_i(n) - h_j(n). They are apart if it is positive for any n.
/// \param branch from the centre of i to that of j, m
inline double separation_along(const Ellipse& i, const Ellipse& j, Vec2 branch, Vec2 n) {
  return dot(branch, n) - (support(i, n).reach + support(j, n).reach);
}

/// Whether one ellipse lies in the other, touching from inside included; to round-off.
bool nested(const Ellipse& i, const Ellipse& j, Vec2 branch);

/// Relative position of two ellipses.
enum class EllipseState {
  apart,     ///< gap > 0
  touching,  ///< gap <= 0, also with a centre inside the other ellipse
  /// One lies in the other: gap, normal and points are those of the shortest separating displacement, but no contact
  /// force follows from them.
  nested,
  concentric,  ///< the centres coincide: as nested, and the sign of the normal is arbitrary
};

/// Result required for ellipses that are apart.
enum class WhenApart {
  distance,         ///< closest points
  only_that_it_is,  ///< a normal that separates them, and as gap a lower bound of the distance, > 0; arms are not
                    ///< filled
};

struct EllipseContact {
  EllipseState state = EllipseState::apart;
  double gap = 0;     ///< m; negative: overlap
  Vec2 normal;        ///< unit, from i to j
  Vec2 arm_i, arm_j;  ///< from the centre to the contact point of each, m: branch + arm_j - arm_i = gap normal

  [[nodiscard]] bool is_contact() const { return state == EllipseState::touching; }
};

/// The error of the gap is of the order of round-off of the sizes, that of the points R/(R + gap) times as large.
/// Swapping i and j mirrors the result bit by bit. Finite numbers give finite numbers. \param branch from the centre of
/// i to that of j, m
/// \param last_normal of the same pair a moment ago, unit: from it the way is short; {} where unknown. It does not
///         change what is found.
EllipseContact contact_of_ellipses(const Ellipse& i, const Ellipse& j, Vec2 branch, Vec2 last_normal = {},
                                   WhenApart when_apart = WhenApart::distance);

/// Within this angle of a maximum its place follows by Taylor's series, to round-off.
double angle_of_arrival(const Ellipse& i, const Ellipse& j);

/// Ellipse i against the half-plane behind a line.
/// \param to_line from the centre of the ellipse to any point of the line, m
/// \param normal of the line, unit, towards the ellipse; that of the result is opposite. Never nested: gap is the
///        distance of the nearest point from the line, however deep
/// \return arm_j from the given point of the line
EllipseContact contact_with_line(const Ellipse& i, Vec2 to_line, Vec2 normal);

/// Ellipse i against a thin segment, its sides or an end: as two ellipses, the segment a flat one.
/// \param to_start, to_end from the centre of the ellipse to the ends, m; distinct
/// \return arm_j from the middle of the segment
EllipseContact contact_with_segment(const Ellipse& i, Vec2 to_start, Vec2 to_end, Vec2 last_normal = {});

/// A contact of body i with body j or a half-plane.
struct Touch {
  double overlap = 0;  ///< m; negative: a gap
  Vec2 normal;         ///< unit, from i
  Vec2 arm_i, arm_j;   ///< from the centres to the contact point
  double share = 1;  ///< of the overlap that lies in i, in proportion to the radii of (discs of the area of) the parts
  std::size_t part_i = 0, part_j = 0;
};

/// Call visitor(touch) for all contacts of two bodies whose gap is smaller than `gap` >= 0.
/// \param branch from the centre of i to that of j, m
template <typename Visitor>
void for_touches(const Outline& i, const Outline& j, Vec2 branch, double gap, const Visitor& visitor) {
  for (std::size_t p = 0; p < i.parts(); ++p) {
    const Ellipse one = i.part(p);
    const Vec2 from = i.offset(p);
    for (std::size_t q = 0; q < j.parts(); ++q) {
      const Ellipse other = j.part(q);
      const Vec2 to = j.offset(q), between = branch + to - from;
      const double reach = one.a + other.a + gap, square = dot(between, between);
      if (square >= reach * reach) continue;
      if (one.is_round() && other.is_round()) {
        const double distance = std::sqrt(square), overlap = one.a + other.a - distance;
        const Vec2 normal = distance > 0 ? between / distance : Vec2{1, 0};
        visitor(Touch{overlap, normal, from + (one.a - overlap / 2) * normal, to - (other.a - overlap / 2) * normal,
                      one.a / (one.a + other.a), p, q});
        continue;
      }
      const EllipseContact found =
          contact_of_ellipses(one, other, between, {}, gap > 0 ? WhenApart::distance : WhenApart::only_that_it_is);
      if (!(found.gap < gap)) continue;
      const double size = std::sqrt(one.a * one.b), other_size = std::sqrt(other.a * other.b);
      visitor(Touch{-found.gap, found.normal, from + found.arm_i, to + found.arm_j, size / (size + other_size), p, q});
    }
  }
}

/// The half plane behind a line: `place` has the distance place . normal + offset from it.
struct HalfPlane {
  Vec2 normal;  ///< unit, towards the bodies
  double offset = 0;
};

/// Call visitor(touch) for all contacts of a body with a half-plane whose gap is smaller than `gap`.
/// \param place of the centre
template <typename Visitor>
void for_touches(const Outline& i, Vec2 place, const HalfPlane& wall, double gap, const Visitor& visitor) {
  const Vec2 out = -wall.normal;
  const double distance = wall.offset - dot(place, out);
  for (std::size_t p = 0; p < i.parts(); ++p) {
    const Vec2 arm = i.offset(p) + support_point(support(i.part(p), out), out);
    const double overlap = dot(arm, out) - distance;
    if (overlap > -gap) visitor(Touch{overlap, out, arm, {}, 1, p});
  }
}

/// OBE_i': the image of ellipse i where ellipse j is the unit circle round the origin. Half-axes a' and b', centre
/// (-h', -k'), turned by -theta' (4.34).
struct MappedEllipse {
  double a = 0, b = 0, theta = 0, h = 0, k = 0;
};

/// (4.12)-(4.28), theta' by atan2 in (4.27), which as printed is undefined for A = B.
/// \param branch from the centre of i to that of j, m
MappedEllipse mapped_ellipse(const Ellipse& i, const Ellipse& j, Vec2 branch);

struct EnlargedEllipseContact {
  double judgement = 0;  ///< JDG (4.32): at most 0 in contact
  Vec2 point;            ///< (x_c, y_c) (4.43) from the centre of i, m
  Vec2 surface_point;    ///< (x_cn, y_cn) (4.47) from the centre of i, m
  double angle = 0;      ///< omega (4.49) of the tangent, rad
  Vec2 normal;           ///< unit, from i to j: (-sin omega, cos omega)

  [[nodiscard]] bool is_contact() const { return judgement <= 0; }
};

/// Points and angle are meaningful only in or near contact, but always finite. Only the judgement is symmetric in i and
/// j.
EnlargedEllipseContact enlarged_ellipse_contact(const Ellipse& i, const Ellipse& j, Vec2 branch);

}  // namespace equidem
