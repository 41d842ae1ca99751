// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/space_filling_curve.hpp"

#include <algorithm>
#include <array>

#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr std::uint32_t side = 1U << 16;

/// Distance along Hilbert's curve of the cell (x, y), both below `side`: quadrant by quadrant, turning the frame so
/// that the curve enters each quadrant where it left the one before.
std::uint32_t hilbert_distance(std::uint32_t x, std::uint32_t y) {
  std::uint32_t distance = 0;
  for (std::uint32_t s = side / 2; s > 0; s /= 2) {
    const std::uint32_t right = (x & s) != 0 ? 1 : 0;
    const std::uint32_t upper = (y & s) != 0 ? 1 : 0;
    distance += s * s * ((3 * right) ^ upper);
    // In the lower half the frame is mirrored at the diagonal, to the right also turned upside down; without
    // branches, of which half would be mispredicted.
    const std::uint32_t turned = (0U - (right & ~upper)) & (side - 1);
    const std::uint32_t exchanged = ((x ^ y) & (upper - 1)) & (side - 1);
    x = (x ^ exchanged) ^ turned;
    y = (y ^ exchanged) ^ turned;
  }
  return distance;
}

struct Key {
  std::uint32_t distance;
  std::int32_t index;
};

/// Stable radix sort by distance, 11 bits at a time.
void sort_by_distance(std::vector<Key>& keys) {
  if (std::ranges::is_sorted(keys, {}, &Key::distance)) return;
  std::vector<Key> other(keys.size());
  for (int bit = 0; bit < 32; bit += 11) {
    std::array<std::size_t, 2049> place{};
    for (const Key& key : keys) ++place[((key.distance >> bit) & 2047U) + 1];
    for (std::size_t k = 1; k < place.size(); ++k) place[k] += place[k - 1];
    for (const Key& key : keys) other[place[(key.distance >> bit) & 2047U]++] = key;
    keys.swap(other);
  }
}

}  // namespace

std::vector<std::int32_t> hilbert_order(std::span<const Vec2> points) {
  if (points.empty()) return {};
  Vec2 low = points[0];
  Vec2 high = points[0];
  for (const Vec2 p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const double extent = std::max(high.x - low.x, high.y - low.y);
  const double scale = extent > 0 ? side / extent : 0;
  const auto cell = [&](double along) {
    return static_cast<std::uint32_t>(std::clamp(along * scale, 0.0, side - 1.0));
  };
  std::vector<Key> keys(points.size());
  parallel_ranges(points.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      keys[k] = {hilbert_distance(cell(points[k].x - low.x), cell(points[k].y - low.y)), static_cast<std::int32_t>(k)};
    }
  });
  sort_by_distance(keys);
  for (auto begin = keys.begin(); begin != keys.end();) {
    auto end = begin + 1;
    while (end != keys.end() && end->distance == begin->distance) ++end;
    if (end - begin > 1) {
      std::sort(begin, end, [&](const Key& a, const Key& b) {
        const Vec2 p = points[a.index];
        const Vec2 q = points[b.index];
        if (p.x != q.x) return p.x < q.x;
        return p.y != q.y ? p.y < q.y : a.index < b.index;
      });
    }
    begin = end;
  }
  std::vector<std::int32_t> order(keys.size());
  std::transform(keys.begin(), keys.end(), order.begin(), [](const Key& key) { return key.index; });
  return order;
}

}  // namespace equidem
