// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// An ellipse and its support function.
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

}  // namespace equidem
