// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/shapes/ellipse.hpp"

namespace equidem {

namespace {

/// The affine map that makes `outer` the unit circle turns the inner ellipse into {c + A w, |w| <= 1}. It lies in the
/// circle when max |c + A w|² <= 1; by duality the maximum is the minimum over l >= mu_1 of |c|² + l + sum (A^T
/// c)_k²/(l - mu_k), in the eigenbasis of A^T A, mu_1 >= mu_2 its eigenvalues: a convex function of l.
bool lies_in(const Ellipse& inner, const Ellipse& outer, Vec2 branch) {
  const auto mapped = [&](Vec2 x) { return Vec2{dot(outer.axis, x) / outer.a, cross(outer.axis, x) / outer.b}; };
  const Vec2 c = mapped(branch);
  const double offset = dot(c, c);
  if (!(offset <= 1)) return false;
  const Vec2 first = inner.a * mapped(inner.axis), second = inner.b * mapped(perpendicular(inner.axis));
  const double xx = dot(first, first), yy = dot(second, second), xy = dot(first, second);
  const double middle = (xx + yy) / 2, half = std::hypot((xx - yy) / 2, xy);
  const double mu_1 = middle + half, mu_2 = middle - half;
  if (mu_1 > 1) return false;
  const double turn = std::atan2(xy, (xx - yy) / 2) / 2, b_x = dot(first, c), b_y = dot(second, c);
  const double b_1 = std::cos(turn) * b_x + std::sin(turn) * b_y, b_2 = std::cos(turn) * b_y - std::sin(turn) * b_x;
  double low = mu_1 + std::abs(b_1), high = mu_1 + std::hypot(b_1, b_2);  // the derivative changes sign between them
  const auto share = [](double b, double gap) { return gap > 0 ? b / gap : 0.0; };
  for (int k = 0; k < 60; ++k) {
    const double l = (low + high) / 2, s_1 = share(b_1, l - mu_1), s_2 = share(b_2, l - mu_2);
    (s_1 * s_1 + s_2 * s_2 > 1 ? low : high) = l;
  }
  return offset + high + b_1 * share(b_1, high - mu_1) + b_2 * share(b_2, high - mu_2) <= 1;
}

}  // namespace

bool nested(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  return lies_in(i, j, -branch) || lies_in(j, i, branch);
}

}  // namespace equidem
