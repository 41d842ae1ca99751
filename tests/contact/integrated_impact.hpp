// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Impacts of spring and dashpot by the classical Runge-Kutta method, with mass, spring and speed 1: an oracle for
/// closed forms.
#pragma once

#include <array>
#include <cmath>
#include <stdexcept>

#include "equidem/contact/restitution.hpp"

namespace equidem {

struct IntegratedImpact {
  double restitution = 0, duration = 0, overlap = 0;  ///< overlap: largest
};

/// \param rate y' of the state y = (x, v, t)
/// \param remains positive while the contact lasts
template <typename Rate, typename Remains>
std::array<long double, 3> integrate_until(Rate rate, Remains remains, long double& largest_x) {
  constexpr long double step = 1e-3L;
  using State = std::array<long double, 3>;
  const auto moved = [](const State& y, const State& k, long double h) {
    return State{y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2]};
  };
  const auto advance = [&](const State& y, long double h) {
    const State a = rate(y), b = rate(moved(y, a, h / 2)), c = rate(moved(y, b, h / 2)), d = rate(moved(y, c, h));
    return moved(
        y, {a[0] + 2 * b[0] + 2 * c[0] + d[0], a[1] + 2 * b[1] + 2 * c[1] + d[1], a[2] + 2 * b[2] + 2 * c[2] + d[2]},
        h / 6);
  };
  const auto zero_of = [&](const State& y, auto f) {
    long double low = 0, high = step;
    for (int i = 0; i < 70; ++i) {
      const long double middle = (low + high) / 2;
      (f(advance(y, middle)) > 0 ? low : high) = middle;
    }
    return advance(y, (low + high) / 2);
  };
  State y{0, 1, 0};
  for (long i = 0; i < 10000000; ++i) {
    const State next = advance(y, step);
    if (y[1] > 0 && next[1] <= 0) {
      const State turning = zero_of(y, [](const State& at) { return at[1]; });
      largest_x = turning[0];
    }
    if (remains(next) <= 0) return zero_of(y, remains);
    y = next;
  }
  throw std::runtime_error("the impact did not end");
}

/// u'' + 2 zeta u' + u = 0 from u = 0, u' = 1.
inline IntegratedImpact integrate_linear_impact(double damping_ratio, ContactEnd end) {
  const long double c = 2 * static_cast<long double>(damping_ratio);
  long double overlap = 0;
  const auto y = integrate_until(
      [c](const auto& s) {
        return std::array<long double, 3>{s[1], -s[0] - c * s[1], 1};
      },
      [c, end](const auto& s) { return end == ContactEnd::at_zero_overlap ? s[0] : s[0] + c * s[1]; }, overlap);
  return {static_cast<double>(-y[1]), static_cast<double>(y[2]), static_cast<double>(overlap)};
}

/// d'' + alpha d^(1/4) d' + d^(3/2) = 0 from d = 0, d' = 1, with d = x^4 and time dt = 4 x³ dtau, which leaves no
/// roots: x' = v, v' = -4 x³ (x^6 + alpha x v).
inline IntegratedImpact integrate_hertz_impact(double alpha, ContactEnd end) {
  long double largest = 0;
  const auto y = integrate_until(
      [alpha](const auto& s) {
        const long double x = s[0], cube = x * x * x;
        return std::array<long double, 3>{s[1], -4 * cube * (cube * cube + alpha * x * s[1]), 4 * cube};
      },
      [alpha, end](const auto& s) {
        const long double x = s[0];
        return end == ContactEnd::at_zero_overlap || x < 0 ? x : x * x * x * x * x + alpha * s[1];
      },
      largest);
  return {static_cast<double>(-y[1]), static_cast<double>(y[2]),
          static_cast<double>(largest * largest * largest * largest)};
}

}  // namespace equidem
