// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Samples shared by the tests of triangulated assemblies.
#pragma once

#include <numeric>
#include <set>
#include <vector>

#include "equidem/assembly/delaunay.hpp"

#include "geometry_oracle.hpp"

namespace equidem {

inline constexpr RadiusDistribution equal_radii = {.smallest = 0.005, .largest = 0.005};
inline constexpr RadiusDistribution unequal_radii = {.smallest = 0.003, .largest = 0.007};

inline double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// The rectangle that a free assembly fills, from its side groups.
inline Vec2 extent(const Assembly& a) {
  if (a.period) return *a.period;
  return {sum(group(a, "bottom").tributary_lengths), sum(group(a, "left").tributary_lengths)};
}

inline std::set<oracle::Pair> pairs(const std::vector<Contact>& contacts) {
  std::set<oracle::Pair> result;
  for (const Contact& c : contacts) result.insert(oracle::pair(c));
  return result;
}

}  // namespace equidem
