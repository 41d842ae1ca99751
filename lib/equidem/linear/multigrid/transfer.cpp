// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/transfer.hpp"

#include <algorithm>

#include "equidem/core/threads.hpp"

namespace equidem::multigrid {
namespace {

constexpr std::size_t cells_per_task = 1 << 9;
constexpr std::size_t points_per_task = 1 << 13;

}  // namespace

Transfer::Transfer(const Grid& grid, std::span<const Place> places) : grid_(grid) {
  std::vector<std::int32_t> cell(places.size());
  std::vector<Inside> inside(places.size());
  parallel_ranges(places.size(), points_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Place host = grid.host(places[k]);
      cell[k] = host.cell;
      inside[k] = {static_cast<float>(host.s), static_cast<float>(host.t)};
    }
  });
  points_ = sort_into_buckets(cell, grid.cells());
  inside_.resize(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) inside_[k] = inside[points_.items[k]];
}

void Transfer::number_nodes(std::span<const std::int32_t> order) {
  std::vector<std::int32_t> number_of_kept(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) number_of_kept[order[k]] = static_cast<std::int32_t>(k);
  std::vector<std::int32_t> number(grid_.nodes(), -1);
  std::size_t kept = 0;
  for (std::size_t node = 0; node < number.size(); ++node) {
    if (grid_.kept(node)) number[node] = number_of_kept[kept++];
  }
  corners_.resize(grid_.cells());
  adjacent_.assign(order.size(), {-1, -1, -1, -1});
  std::vector<std::uint8_t> found(order.size(), 0);
  for (std::size_t cell = 0; cell < corners_.size(); ++cell) {
    const auto nodes = grid_.nodes_of(cell);
    for (std::size_t k = 0; k < 4; ++k) {
      const std::int32_t node = corners_[cell][k] = number[nodes[k]];
      if (node >= 0) adjacent_[node][found[node]++] = static_cast<std::int32_t>(4 * cell + k);
    }
  }
}

/// visit(corner, weight, turn): the motion of the point is weight (U + w turn).
template <typename Visit>
void Transfer::visit_corners(std::size_t cell, std::int32_t point, const Visit& visit) const {
  const auto [s, t] = inside_[point];
  if (!grid_.full(cell)) {
    const Shape shape = grid_.shape({static_cast<std::int32_t>(cell), s, t});
    for (int k = 0; k < 4; ++k) {
      visit(k, static_cast<float>(shape.weight[k]),
            Quad{-static_cast<float>(shape.arm[k].y), static_cast<float>(shape.arm[k].x), 0, 0});
    }
    return;
  }
  const auto half_x = 0.5F * static_cast<float>(grid_.spacing().x),
             half_y = 0.5F * static_cast<float>(grid_.spacing().y);
  const float left = half_x * s, right = half_x * (s - 1), below = half_y * t, above = half_y * (t - 1);
  visit(0, (1 - s) * (1 - t), Quad{-below, left, 0, 0});
  visit(1, s * (1 - t), Quad{-below, right, 0, 0});
  visit(2, (1 - s) * t, Quad{-above, left, 0, 0});
  visit(3, s * t, Quad{-above, right, 0, 0});
}

void Transfer::restrict_forces(const QuadVector& points, QuadVector& nodes, QuadVector& cells) const {
  cells.resize(4 * corners_.size());
  parallel_ranges(corners_.size(), cells_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) {
      Quad sum[4] = {};
      for (std::int32_t point = points_.first[cell]; point < points_.first[cell + 1]; ++point) {
        const Quad force = points[point];
        visit_corners(cell, point, [&](int k, float weight, Quad turn) {
          sum[k] += weight * (force + Quad{0, 0, force[0] * turn[0] + force[1] * turn[1], 0});
        });
      }
      std::copy(sum, sum + 4, &cells[4 * cell]);
    }
  });
  parallel_ranges(adjacent_.size(), points_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      Quad sum{};
      for (const std::int32_t place : adjacent_[node]) {
        if (place >= 0) sum += cells[place];
      }
      nodes[node] = sum;
    }
  });
}

void Transfer::add_motions(const QuadVector& nodes, QuadVector& points) const {
  parallel_ranges(corners_.size(), cells_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) {
      Quad motion[4];
      for (int k = 0; k < 4; ++k) motion[k] = corners_[cell][k] >= 0 ? nodes[corners_[cell][k]] : Quad{};
      for (std::int32_t point = points_.first[cell]; point < points_.first[cell + 1]; ++point) {
        Quad sum = points[point];
        visit_corners(cell, point,
                      [&](int k, float weight, Quad turn) { sum += weight * (motion[k] + motion[k][2] * turn); });
        points[point] = sum;
      }
    }
  });
}

double Transfer::bytes() const {
  return 12.0 * static_cast<double>(points_.items.size()) + 84.0 * static_cast<double>(corners_.size()) +
         16.0 * static_cast<double>(adjacent_.size());
}

std::vector<std::int32_t> order_along(const Grid& grid) {
  std::vector<std::int32_t> kept(grid.nodes(), -1);
  std::int32_t count = 0;
  for (std::size_t node = 0; node < kept.size(); ++node) {
    if (grid.kept(node)) kept[node] = count++;
  }
  std::vector<std::int32_t> order;
  const std::size_t columns = grid.columns(), rows = grid.nodes() / columns;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const std::size_t node = grid.wide() ? k % rows * columns + k / rows : k;
    if (kept[node] >= 0) order.push_back(kept[node]);
  }
  return order;
}

std::vector<double> node_masses(const Grid& grid, std::span<const Place> places, std::span<const double> masses) {
  std::vector<double> result(grid.nodes(), 0.0);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto nodes = grid.nodes_of(places[k].cell);
    const double s = places[k].s, t = places[k].t;
    const double weights[] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
    for (int e = 0; e < 4; ++e) result[nodes[e]] += masses[k] * weights[e];
  }
  return result;
}

}  // namespace equidem::multigrid
