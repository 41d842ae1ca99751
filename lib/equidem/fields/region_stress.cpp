// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/fields/region_stress.hpp"

#include <algorithm>
#include <vector>

namespace equidem {
namespace {

/// The part of the way from a point that lies in a rectangle.
Vec2 part_inside(const Rectangle& region, Vec2 from, Vec2 way) {
  double first = 0, last = 1;
  const auto cut = [&](double start, double along, double low, double high) {
    if (along == 0) {
      if (start < low || start > high) last = first;
      return;
    }
    const double a = (low - start) / along, b = (high - start) / along;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  };
  cut(from.x, way.x, region.low.x, region.high.x);
  cut(from.y, way.y, region.low.y, region.high.y);
  return std::max(0.0, last - first) * way;
}

}  // namespace

Tensor2 region_stress(const Rectangle& region, std::span<const std::int32_t> bodies, std::span<const DiscMotion> places,
                      std::span<const BodyContact> contacts) {
  std::vector<char> counts(places.size(), 0);
  for (const std::int32_t body : bodies) counts[static_cast<std::size_t>(body)] = 1;
  Tensor2 sum;
  for (const BodyContact& contact : contacts) {
    const Vec2 at_i = places[static_cast<std::size_t>(contact.i)].u;
    if (counts[static_cast<std::size_t>(contact.i)] != 0)
      sum += outer(contact.force, part_inside(region, at_i, contact.arm));
    if (contact.j < 0 || counts[static_cast<std::size_t>(contact.j)] == 0) continue;
    const Vec2 at_j = places[static_cast<std::size_t>(contact.j)].u;
    sum += outer(-contact.force, part_inside(region, at_j, at_i + contact.arm - contact.shift - at_j));
  }
  const Vec2 sides = region.high - region.low;
  return (1 / (sides.x * sides.y)) * sum;
}

}  // namespace equidem
