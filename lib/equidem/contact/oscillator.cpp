// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/oscillator.hpp"

#include <cmath>

namespace equidem {

namespace {

/// g' from g' + 2 zeta g + g[1] = 1.
double slope_of(double zeta, const Response& r) {
  return 1 - r.g[1] - 2 * zeta * r.g[0];
}

/// For x (1 + 2 zeta) <= 1: power series of g[4] and g[5]; the others by g[k] = x^(k+1)/(k+1)! - 2 zeta g[k+1] -
/// g[k+2], in which the first term is the large one.
Response response_by_series(double zeta, double x) {
  double power[6];  // x^(k+1)/(k+1)!
  power[0] = x;
  for (int k = 1; k < 6; ++k) power[k] = power[k - 1] * x / (k + 1);
  double fourth = 0, fifth = 0, before = 0, now = power[4];  // now = g^(n+1)(0) x^(n+5)/(n+5)!
  for (int n = 0; n < 20; ++n) {
    fourth += now;
    fifth += now * x / (n + 6);
    // the derivatives follow the equation itself: c_(n+1) = -2 zeta c_n - c_(n-1)
    const double next = -x / (n + 6) * (2 * zeta * now + x / (n + 5) * before);
    before = now;
    now = next;
  }
  Response r;
  r.g[4] = fourth;
  r.g[3] = power[3] - 2 * zeta * fourth - fifth;
  for (int k = 2; k >= 0; --k) r.g[k] = power[k] - 2 * zeta * r.g[k + 1] - r.g[k + 2];
  r.slope = slope_of(zeta, r);
  return r;
}

/// From x to 2x: g[k] is the divided difference of exp at (0, ..., 0, l1, l2), l the roots of l² + 2 zeta l + 1, and
/// products of such make those of twice the time (Leibniz). For zeta >= 1 every term is positive.
Response twice(double zeta, double x, const Response& r) {
  const double* g = r.g;
  const double p = 1 - g[1];  // g' + 2 zeta g
  Response s;
  s.g[0] = g[0] * (2 * p - 2 * zeta * g[0]);
  s.g[1] = g[1] * (1 + p) + g[0] * g[0];
  s.g[2] = g[2] * (1 + p) + g[1] * (x + g[0]);
  s.g[3] = g[3] * (1 + p) + g[2] * (x + g[0]) + g[1] * x * x / 2;
  s.g[4] = g[4] * (1 + p) + g[3] * (x + g[0]) + g[2] * x * x / 2 + g[1] * x * x * x / 6;
  s.slope = slope_of(zeta, s);
  return s;
}

/// The halvings of x that bring x (1 + 2 zeta) below the bound.
int halvings(double zeta, double x, double bound) {
  const double size = x * (1 + 2 * zeta) / bound;
  return size <= 1 ? 0 : std::ilogb(size) + 1;
}

}  // namespace

Response response(double zeta, double x) {
  if (zeta < 1 && x > 2) {
    const double beta = std::sqrt((1 - zeta) * (1 + zeta));
    const double decay = std::exp(-zeta * x);
    Response r;
    r.g[0] = decay * std::sin(beta * x) / beta;
    r.slope = decay * std::cos(beta * x) - zeta * r.g[0];
    r.g[1] = 1 - r.slope - 2 * zeta * r.g[0];
    r.g[2] = x - r.g[0] - 2 * zeta * r.g[1];
    r.g[3] = x * x / 2 - r.g[1] - 2 * zeta * r.g[2];
    r.g[4] = x * x * x / 6 - r.g[2] - 2 * zeta * r.g[3];
    return r;
  }
  int left = halvings(zeta, x, 1);
  Response r = response_by_series(zeta, std::ldexp(x, -left));
  for (; left > 0; --left) r = twice(zeta, std::ldexp(x, -left), r);
  if (zeta >= 1) {  // g' + s g = exp(-f x), f + s = 2 zeta, f s = 1, where the sum above leaves nothing of g'
    const double fast = zeta + std::sqrt((zeta - 1) * (zeta + 1));
    r.slope = std::exp(-fast * x) - r.g[0] / fast;
  }
  return r;
}

/// Gauss's rule where the functions are smooth, then from x to 2x: the second half is the first one, begun with the
/// state at x. Sums of squares throughout.
ResponseProducts products_of_response(double zeta, double x) {
  int left = halvings(zeta, x, 0.125);
  const double start = std::ldexp(x, -left);
  ResponseProducts sum;
  const double root = 2 * std::sqrt(10.0 / 7), edge = 13 * std::sqrt(70.0);
  const double node[3] = {0, std::sqrt(5 - root) / 3, std::sqrt(5 + root) / 3};
  const double weight[3] = {128.0 / 225, (322 + edge) / 900, (322 - edge) / 900};
  for (int i = -2; i <= 2; ++i) {
    const double place = std::copysign(node[std::abs(i)], i);
    const Response r = response_by_series(zeta, start * (1 + place) / 2);
    const double w = weight[std::abs(i)] * start / 2;
    const double a = r.slope, b = r.g[0], c = r.g[1];
    const double terms[6] = {a * a, b * b, c * c, 2 * a * b, 2 * a * c, 2 * b * c};
    for (int k = 0; k < 6; ++k) sum.of[k] += w * terms[k];
  }
  Response r = response_by_series(zeta, start);
  for (; left > 0; --left) {
    const double now = std::ldexp(x, -left);
    // [v, b, h1] at x of those at 0: v' = (g', g, g1), b' = (-g, 1 - g1, x - g2), h1
    const double va = r.slope, vb = r.g[0], vc = r.g[1];
    const double ba = -r.g[0], bb = 1 - r.g[1], bc = now - r.g[2];
    const double aa = sum.of[0], dd = sum.of[1], cc = sum.of[2], ab = sum.of[3], ac = sum.of[4], bd = sum.of[5];
    sum.of[0] += aa * va * va + dd * ba * ba + ab * va * ba;
    sum.of[1] += aa * vb * vb + dd * bb * bb + ab * vb * bb;
    sum.of[2] += aa * vc * vc + dd * bc * bc + cc + ab * vc * bc + ac * vc + bd * bc;
    sum.of[3] += 2 * aa * va * vb + 2 * dd * ba * bb + ab * (va * bb + vb * ba);
    sum.of[4] += 2 * aa * va * vc + 2 * dd * ba * bc + ab * (va * bc + vc * ba) + ac * va + bd * ba;
    sum.of[5] += 2 * aa * vb * vc + 2 * dd * bb * bc + ab * (vb * bc + vc * bb) + ac * vb + bd * bb;
    r = twice(zeta, now, r);
  }
  return sum;
}

}  // namespace equidem
