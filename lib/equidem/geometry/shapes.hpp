// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Shapes of bodies: discs, ellipses, and clumps, which are discs tied rigidly; rectangles.
///
/// Support function, reach and levers, exact areas and their parts within a rectangle.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "equidem/core/vector.hpp"

namespace equidem {

struct Rectangle {
  Vec2 low;   ///< m
  Vec2 high;  ///< m
  [[nodiscard]] double area() const { return (high.x - low.x) * (high.y - low.y); }
};

/// The x-axis of a body at an angle as unit vector, to 1e-15; bit-identical on every machine.
Vec2 axis_at(double angle);
Vec2 axis_of_turns(double turns);  ///< angle over 2 pi

/// Half-axes a >= b, a along `axis` and b across it, m. a = b: a disc, b = 0: a segment, a = 0: a point.
struct Ellipse {
  double a = 0, b = 0;
  Vec2 axis = {1, 0};  ///< unit

  [[nodiscard]] bool is_round() const { return a == b; }
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

/// Whether a point lies in the ellipse.
/// \param branch from the centre of the ellipse to the point
inline bool holds(const Ellipse& e, Vec2 branch) {
  const double x = dot(e.axis, branch) / e.a, y = cross(e.axis, branch) / e.b;
  return x * x + y * y < 1;
}

/// b/a; 1 for points and segments. The sharpest radius of curvature is b roundness.
inline double roundness(const Ellipse& e) {
  return e.b > 0 ? e.b / e.a : 1;
}

/// Discs tied rigidly, in the frame of their body: the origin is the centre of mass, the angle of the body is 0.
struct Clump {
  struct Disc {
    Vec2 offset;        ///< of the centre, m
    double radius = 0;  ///< m
  };
  std::vector<Disc> discs;
};

/// \throws Error (bad_input) on no discs, a radius that is not positive, numbers that are not finite
void check(const Clump& clump);

/// The discs, shifted so that the centroid of their union is the origin.
/// \param discs in any position, overlapping or not
/// \throws Error (bad_input) as check(clump), and on a disc within another
Clump centred_clump(std::vector<Clump::Disc> discs);

/// Radius of the circle round the origin that contains all discs, m.
double radius_of(const Clump& clump);

/// Area moments of a union of discs.
struct DiscUnion {
  double area = 0;          ///< m²
  Vec2 centre;              ///< centroid, m
  double polar_moment = 0;  ///< integral of the squared distance from the centroid, m⁴
};
DiscUnion union_of(std::span<const Clump::Disc> discs);

/// A body at its angle, its centre of mass in the origin: one part, a disc or an ellipse, or the discs of a clump.
struct Outline {
  double a = 0, b = 0;                      ///< half-axes of a disc or an ellipse, m
  Vec2 axis = {1, 0};                       ///< the direction of its x-axis
  std::span<const Clump::Disc> discs = {};  ///< a clump: instead of half-axes, times `scale`
  double scale = 1;

  [[nodiscard]] bool is_disc() const { return discs.empty() && a == b; }
  [[nodiscard]] std::size_t parts() const { return discs.empty() ? 1 : discs.size(); }
  /// \return the centre of a part, m
  [[nodiscard]] Vec2 offset(std::size_t part) const {
    if (discs.empty()) return {};
    const Vec2 x = scale * discs[part].offset;
    return {axis.x * x.x - axis.y * x.y, axis.y * x.x + axis.x * x.y};
  }
  [[nodiscard]] Ellipse part(std::size_t part) const {
    if (discs.empty()) return {a, b, axis};
    const double radius = scale * discs[part].radius;
    return {radius, radius, axis};
  }
};

/// Radius of the circle round the centre that holds the body, m.
double reach_of(const Outline& outline);
/// Reach of a body from its centre in a direction, m: the largest support of its parts.
double reach_along(const Outline& outline, Vec2 direction);
/// Radius of the smallest circle that is inscribed in a part, m.
double inscribed_radius(const Outline& outline);
/// Longest lever of a normal force about the centre, m: a - b for an ellipse, 0 for a disc.
double longest_lever(const Outline& outline);

/// Whether a part of one body has its centre in a part of the other, or ellipses intersect so deeply that the lines
/// between the centres of curvature of their tips cross. For discs: whether the centre of one is in the other.
/// \param branch from the centre of i to that of j, m
bool are_inside_one_another(const Outline& i, const Outline& j, Vec2 branch);

/// m²
double area_of(const Outline& outline);
/// Area of the part of a body within a rectangle, m².
double clipped_area(const Outline& outline, Vec2 centre, const Rectangle& region);
/// Area of the part of a union of discs within a rectangle, m².
double clipped_area(std::span<const Clump::Disc> discs, const Rectangle& region);

}  // namespace equidem
