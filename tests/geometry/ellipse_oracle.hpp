// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contact of two ellipses by a search over all directions, slowly and in long double; and whether they overlap, by
/// algebra.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "equidem/geometry/shape_contact.hpp"

namespace equidem::oracle {

using Real = long double;
struct Point {
  Real x = 0, y = 0;
};

/// In one direction: branch . n - h_i - h_j, its derivative by the angle, and the points that reach farthest.
struct Look {
  Point n;
  Real gap = 0, slope = 0;
  Point arm_i, arm_j;
  Real radius = 0;  ///< sum of the radii of curvature
};

struct Found : Look {
  Real second = 0;  ///< the next highest maximum
};

struct Reach {
  Real h;
  Point point;
  Real radius;
};

/// The point of the ellipse farthest along n: the image of n under P = R diag(a², b²) R^T over h = sqrt(n P n).
inline Reach reach(const Ellipse& e, Point n) {
  const Real ux = e.axis.x, uy = e.axis.y, a = e.a, b = e.b;
  const Real p = (ux * n.x + uy * n.y) * a * a, q = (-uy * n.x + ux * n.y) * b * b;
  const Real h = std::sqrt(p * (ux * n.x + uy * n.y) + q * (-uy * n.x + ux * n.y));
  return {h, {(p * ux - q * uy) / h, (p * uy + q * ux) / h}, a * a * b * b / (h * h * h)};
}

inline Look look(const Ellipse& i, const Ellipse& j, Vec2 branch, Point n) {
  const Reach of_i = reach(i, n), of_j = reach(j, n);
  const Point from = {branch.x - of_i.point.x - of_j.point.x, branch.y - of_i.point.y - of_j.point.y};
  return {n,
          branch.x * n.x + branch.y * n.y - of_i.h - of_j.h,
          n.x * from.y - n.y * from.x,
          of_i.point,
          {-of_j.point.x, -of_j.point.y},
          of_i.radius + of_j.radius};
}

/// All maxima between neighbouring directions, each by bisection of the derivative; the highest.
inline Found contact(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  constexpr std::size_t count = 720;
  static const auto directions = [] {
    std::array<Vec2, count> all;
    for (std::size_t k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / count;
      all[k] = {std::cos(angle), std::sin(angle)};
    }
    return all;
  }();
  std::array<double, count> gaps;
  for (std::size_t k = 0; k < count; ++k) gaps[k] = separation_along(i, j, branch, directions[k]);
  Found best;
  best.gap = best.second = -1e300L;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t before = (k + count - 1) % count, after = (k + 1) % count;
    if (gaps[k] < gaps[before] || gaps[k] <= gaps[after]) continue;
    Point low = {directions[before].x, directions[before].y}, high = {directions[after].x, directions[after].y};
    Look middle;
    for (int step = 0; step < 66; ++step) {
      const Real x = low.x + high.x, y = low.y + high.y, length = std::sqrt(x * x + y * y);
      middle = look(i, j, branch, {x / length, y / length});
      (middle.slope > 0 ? low : high) = middle.n;
    }
    if (middle.gap > best.gap) {
      best.second = best.gap;
      static_cast<Look&>(best) = middle;
    } else {
      best.second = std::max(best.second, middle.gap);
    }
  }
  return best;
}

/// Whether the ellipses are apart: whether det(l A + B) has two distinct positive roots l, A and B the conics, negative
/// inside (Wang, Wang & Kim 2001). In the frame where i is the unit circle and the axes are those of the image of j,
/// with half-axes 1/sqrt(q_k) and centre d: (l + q_1)(l + q_2)(s - 1 - l) - q_1² d_1² (l + q_2) - q_2² d_2² (l + q_1),
/// s = q_1 d_1² + q_2 d_2².
inline bool apart_by_algebra(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  const auto mapped = [&](Vec2 x) { return Point{Real(dot(i.axis, x)) / i.a, Real(cross(i.axis, x)) / i.b}; };
  const Point c = mapped(branch), u = mapped(j.axis), v = mapped(perpendicular(j.axis));
  const Real a2 = Real(j.a) * j.a, b2 = Real(j.b) * j.b;
  const Real xx = a2 * u.x * u.x + b2 * v.x * v.x, yy = a2 * u.y * u.y + b2 * v.y * v.y;
  const Real xy = a2 * u.x * u.y + b2 * v.x * v.y, angle = std::atan2(2 * xy, xx - yy) / 2;
  const Real cosine = std::cos(angle), sine = std::sin(angle), half = std::hypot((xx - yy) / 2, xy);
  const Real q1 = 1 / ((xx + yy) / 2 + half);
  const Real q2 = ((xx + yy) / 2 + half) / (xx * yy - xy * xy);
  const Real d1 = cosine * c.x + sine * c.y, d2 = cosine * c.y - sine * c.x;
  const Real r1 = q1 * d1 * d1, r2 = q2 * d2 * d2, m = r1 + r2 - 1;
  // l³ + k2 l² + k1 l + k0, the determinant times -1
  const Real k2 = q1 + q2 - m, k1 = q1 * q2 - m * (q1 + q2) + q1 * r1 + q2 * r2, k0 = q1 * q2 * (r1 + r2 - m);
  const Real discriminant =
      18 * k2 * k1 * k0 - 4 * k2 * k2 * k2 * k0 + k2 * k2 * k1 * k1 - 4 * k1 * k1 * k1 - 27 * k0 * k0;
  return discriminant > 0 && (k2 < 0 || k1 < 0);
}

}  // namespace equidem::oracle
