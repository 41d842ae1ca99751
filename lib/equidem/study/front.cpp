// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/front.hpp"

#include <algorithm>
#include <cmath>

namespace equidem {

std::vector<std::size_t> front_of(std::span<const CostPoint> points) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (std::isfinite(points[k].seconds) && std::isfinite(points[k].error)) order.push_back(k);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const CostPoint &p = points[a], &q = points[b];
    return p.seconds != q.seconds ? p.seconds < q.seconds : p.error < q.error;
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t k : order) {
    if (points[k].error >= least) continue;
    least = points[k].error;
    front.push_back(k);
  }
  return front;
}

std::optional<std::size_t> cheapest_within(std::span<const CostPoint> points, double error) {
  for (const std::size_t k : front_of(points)) {
    if (points[k].error <= error) return k;
  }
  return {};
}

}  // namespace equidem
