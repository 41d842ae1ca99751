// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// An ellipse and its support function.
///
/// The exact contact of two ellipses: closest points and common normal.
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

#include "equidem/core/vector.hpp"

namespace equidem {

/// Half-axes a >= b, a along `axis` and b across it, m. a = b: a disc, b = 0: a segment, a = 0: a point.
struct Ellipse {
  double a = 0, b = 0;
  Vec2 axis = {1, 0};  ///< unit

  /// \param angle of the half-axis a, rad
  static Ellipse at_angle(double a, double b, double angle) { return {a, b, {std::cos(angle), std::sin(angle)}}; }
};

/// In the direction of a unit vector n at the angle phi: h(phi) = max of x . n over the ellipse, x from its centre.
struct EllipseSupport {
  double reach = 0;         ///< h, m
  double slope = 0;         ///< h', m: the point that reaches farthest is h n + h' s, s = (-n_y, n_x)
  double radius = 0;        ///< R = h + h'', m: radius of curvature at that point
  double radius_slope = 0;  ///< R', m
};

/// h = sqrt(a² p² + b² q²), h' = (b² - a²) p q/h, R = a² b²/h³, R' = -3 R h'/h with p = n . axis, q = n across it.
inline EllipseSupport support(const Ellipse& e, Vec2 n) {
  const double p = dot(e.axis, n), q = cross(e.axis, n), x = e.a * p, y = e.b * q;
  const double reach = std::sqrt(x * x + y * y);
  if (reach == 0) return {};
  const double inverse = 1 / reach, w = e.a * e.b * inverse;
  const double slope = (e.b - e.a) * (e.b + e.a) * p * q * inverse, radius = w * w * inverse;
  return {reach, slope, radius, -3 * radius * slope * inverse};
}

/// From the centre to the point that reaches farthest along n.
inline Vec2 support_point(const EllipseSupport& s, Vec2 n) {
  return s.reach * n + s.slope * perpendicular(n);
}

/// b/a; 1 for points and segments. The sharpest radius of curvature is b roundness.
inline double roundness(const Ellipse& e) {
  return e.b > 0 ? e.b / e.a : 1;
}

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
