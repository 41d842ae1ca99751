// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Differences of states of rest, rotations times the mean radius.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "equidem/statics/equilibrium.hpp"

namespace equidem::test {

/// Largest difference of any motion over the largest motion of q.
inline double largest_difference(const Assembly& assembly, const Equilibrium& p, const Equilibrium& q) {
  const double a = assembly.mean_radius();
  double off = 0, size = 0;
  for (std::size_t d = 0; d < p.motions.size(); ++d) {
    off = std::max({off, norm(p.motions[d].u - q.motions[d].u), a * std::abs(p.motions[d].theta - q.motions[d].theta)});
    size = std::max({size, norm(q.motions[d].u), a * std::abs(q.motions[d].theta)});
  }
  return size == 0 ? off : off / size;
}

/// |p - q| over |q|, 2-norms.
inline double relative_difference(const Assembly& assembly, const std::vector<DiscMotion>& p,
                                  const std::vector<DiscMotion>& q) {
  const double a = assembly.mean_radius();
  const auto square = [&](const DiscMotion& m) { return squared(m.u) + squared(a * m.theta); };
  double off = 0, size = 0;
  for (std::size_t d = 0; d < p.size(); ++d) {
    off += square({p[d].u - q[d].u, p[d].theta - q[d].theta});
    size += square(q[d]);
  }
  return size == 0 ? std::sqrt(off) : std::sqrt(off / size);
}
inline double relative_difference(const Assembly& assembly, const Equilibrium& p, const Equilibrium& q) {
  return relative_difference(assembly, p.motions, q.motions);
}

}  // namespace equidem::test
