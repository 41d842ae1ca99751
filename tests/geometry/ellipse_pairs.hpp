// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Random pairs of ellipses.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/random.hpp"
#include "equidem/geometry/shape_contact.hpp"

#include "geometry/ellipse_oracle.hpp"

namespace equidem::test {

struct TwoEllipses {
  Ellipse i, j;
  Vec2 branch;

  [[nodiscard]] double size() const { return std::max(i.a, j.a); }
  [[nodiscard]] EllipseContact contact(Vec2 last_normal = {}) const {
    return contact_of_ellipses(i, j, branch, last_normal);
  }
};

inline Vec2 random_direction(Random& random) {
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  return {std::cos(angle), std::sin(angle)};
}

inline Ellipse random_ellipse(Random& random, double most_aspect) {
  const double size = std::exp(random.uniform(-0.7, 0.7)),
               root = std::exp(random.uniform(0, std::log(most_aspect) / 2));
  return {size * root, size / root, random_direction(random)};
}

/// From concentric to well apart.
inline TwoEllipses random_pair(Random& random, double most_aspect) {
  const Ellipse i = random_ellipse(random, most_aspect), j = random_ellipse(random, most_aspect);
  return {i, j, random.uniform(0, 1.2) * (i.a + j.a) * random_direction(random)};
}

inline double off(oracle::Point a, Vec2 b) {
  return static_cast<double>(std::hypot(a.x - b.x, a.y - b.y));
}

}  // namespace equidem::test
