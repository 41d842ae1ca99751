// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Elasticity tensors and turned assemblies for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/matrix.hpp"
#include "equidem/core/random.hpp"

namespace samples {

using namespace equidem;

/// Largest entry by magnitude.
inline double largest(const Matrix3& a) {
  double result = 0;
  for (const auto& row : a) {
    for (const double entry : row) result = std::max(result, std::abs(entry));
  }
  return result;
}

/// Largest difference of two entries over the largest entry of b.
inline double relative_difference(const Matrix3& a, const Matrix3& b) {
  double result = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t s = 0; s < 3; ++s) result = std::max(result, std::abs(a[r][s] - b[r][s]));
  }
  return result / largest(b);
}

inline bool all_finite(const Matrix3& a) {
  for (const auto& row : a) {
    for (const double entry : row) {
      if (!std::isfinite(entry)) return false;
    }
  }
  return true;
}

inline std::string shown(const Matrix3& a) {
  std::string text;
  for (const auto& row : a) {
    for (const double entry : row) text += std::to_string(entry) + " ";
    text += "; ";
  }
  return text;
}

/// The fourth-order tensor C_ijkl e_kl of a symmetric strain, written out.
inline Voigt stress_of(const Matrix3& c, const Voigt& e) {
  const auto row = [&](std::size_t r) { return c[r][0] * e.xx + c[r][1] * e.yy + c[r][2] * e.xy; };
  return {row(0), row(1), row(2)};
}

/// sum of weight v v^T over the weights, each with a random v: with positive weights semi-definite, of their number as
/// rank.
inline Matrix3 random_stiffness(Random& random, const std::vector<double>& weights) {
  Matrix3 c{};
  for (const double weight : weights) {
    const double v[3] = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t s = 0; s < 3; ++s) c[r][s] += weight * v[r] * v[s];
    }
  }
  return c;
}

/// A copy turned counter-clockwise about the origin. Only of a free assembly: a period would have to turn along.
inline Assembly turned(Assembly assembly, double angle) {
  const Vec2 x{std::cos(angle), std::sin(angle)}, y = perpendicular(x);
  for (Vec2& centre : assembly.centres) centre = centre.x * x + centre.y * y;
  assembly.box.reset();
  return assembly;
}

/// kN in [0.5, 1.5], kT in [low, 1], one pair for each contact.
inline ContactSprings random_springs(const Assembly& assembly, double low, std::uint64_t seed) {
  Random random(seed);
  std::vector<SpringConstants> springs(assembly.contacts.size());
  for (SpringConstants& k : springs) {
    k.kN = random.uniform(0.5, 1.5);
    k.kT = random.uniform(low, 1);
  }
  return ContactSprings(std::move(springs));
}

}  // namespace samples
