// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Vectors and second-order tensors of the plane.
///
/// Sign conventions of the whole library: SI units per metre of depth (springs in Pa, forces in N/m,
/// stress in Pa), angles in radians counter-clockwise, tension positive. For a contact of discs i and j the normal n
/// points from i to j and the tangent is s = (-n_y, n_x).
#pragma once

#include <cmath>

namespace equidem {

/// A vector of the plane (metres for positions and displacements, N/m for forces).
struct Vec2 {
  double x = 0;
  double y = 0;

  constexpr Vec2& operator+=(Vec2 b) { return x += b.x, y += b.y, *this; }
  constexpr Vec2& operator-=(Vec2 b) { return x -= b.x, y -= b.y, *this; }
  constexpr Vec2& operator*=(double c) { return x *= c, y *= c, *this; }
  friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec2 operator-(Vec2 a) { return {-a.x, -a.y}; }
  friend constexpr Vec2 operator*(double c, Vec2 a) { return {c * a.x, c * a.y}; }
  friend constexpr Vec2 operator*(Vec2 a, double c) { return c * a; }
  friend constexpr Vec2 operator/(Vec2 a, double c) { return {a.x / c, a.y / c}; }
  constexpr bool operator==(const Vec2&) const = default;
};

constexpr double dot(Vec2 a, Vec2 b) {
  return a.x * b.x + a.y * b.y;
}
/// The out-of-plane component of a x b: the moment of the force b at the position a.
constexpr double cross(Vec2 a, Vec2 b) {
  return a.x * b.y - a.y * b.x;
}
/// a turned by +90 degrees: the contact tangent s = (-n_y, n_x) of the normal n.
constexpr Vec2 perpendicular(Vec2 a) {
  return {-a.y, a.x};
}
constexpr double squared(double x) {
  return x * x;
}
constexpr double squared(Vec2 a) {
  return dot(a, a);
}
inline double norm(Vec2 a) {
  return std::sqrt(squared(a));
}

/// A second-order tensor, not assumed symmetric: stress s_ij = sum F_i l_j is symmetric only where no moment acts on
/// the discs (Abe 1996, eq. 55).
struct Tensor2 {
  double xx = 0;
  double xy = 0;
  double yx = 0;
  double yy = 0;

  constexpr Tensor2& operator+=(const Tensor2& b) { return xx += b.xx, xy += b.xy, yx += b.yx, yy += b.yy, *this; }
  constexpr Tensor2& operator*=(double c) { return xx *= c, xy *= c, yx *= c, yy *= c, *this; }
  friend constexpr Tensor2 operator*(double c, Tensor2 a) { return a *= c; }
  friend constexpr Tensor2 operator+(Tensor2 a, const Tensor2& b) { return a += b; }
};

/// a_i b_j.
constexpr Tensor2 outer(Vec2 a, Vec2 b) {
  return {a.x * b.x, a.x * b.y, a.y * b.x, a.y * b.y};
}
/// t_ij v_j.
constexpr Vec2 operator*(const Tensor2& t, Vec2 v) {
  return {t.xx * v.x + t.xy * v.y, t.yx * v.x + t.yy * v.y};
}
inline double frobenius_norm(const Tensor2& t) {
  return std::hypot(norm({t.xx, t.xy}), norm({t.yx, t.yy}));
}
/// t_xy - t_yx: zero for a symmetric tensor.
constexpr double asymmetry(const Tensor2& t) {
  return t.xy - t.yx;
}

/// Stress or strain in Voigt order (xx, yy, xy). A strain carries the engineering shear gamma_xy = 2 e_xy.
struct Voigt {
  double xx = 0;
  double yy = 0;
  double xy = 0;
};

/// The symmetric part of a stress in Voigt order.
constexpr Voigt voigt_stress(const Tensor2& s) {
  return {s.xx, s.yy, 0.5 * (s.xy + s.yx)};
}
/// The symmetric part of a displacement gradient h_ij = du_i/dx_j in Voigt order with engineering shear.
constexpr Voigt voigt_strain(const Tensor2& h) {
  return {h.xx, h.yy, h.xy + h.yx};
}

}  // namespace equidem
