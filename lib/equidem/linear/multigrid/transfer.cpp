// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/transfer.hpp"

#include <algorithm>
#include <array>

#include "equidem/core/threads.hpp"

namespace equidem::multigrid {
namespace {

constexpr std::size_t points_per_task = 1 << 13;
constexpr std::int32_t points_per_chunk = 1 << 10;

/// The motion of a point is sum w_k (U_k + a theta_k turn_k) over the corners k.
struct Corner {
  float weight;
  Quad turn;
};

std::array<Corner, 4> corners_at(const Grid& grid, std::int32_t cell, float s, float t) {
  const Shape shape = grid.shape({cell, s, t});
  std::array<Corner, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) {
    corners[k] = {static_cast<float>(shape.weight[k]),
                  Quad{-static_cast<float>(shape.arm[k].y), static_cast<float>(shape.arm[k].x), 0, 0}};
  }
  return corners;
}

}  // namespace

Transfer::Transfer(const Grid& grid, std::span<const Place> places) : grid_(grid), cells_(grid.cell_order()) {
  std::vector<std::int32_t> position(cells_.size());
  for (std::size_t k = 0; k < cells_.size(); ++k) position[cells_[k]] = static_cast<std::int32_t>(k);
  std::vector<std::int32_t> cell(places.size());
  std::vector<Inside> inside(places.size());
  parallel_ranges(places.size(), points_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Place host = grid.host(places[k]);
      cell[k] = position[host.cell];
      inside[k] = {static_cast<float>(host.s), static_cast<float>(host.t)};
    }
  });
  points_ = sort_into_buckets(cell, grid.cells());
  inside_.resize(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) inside_[k] = inside[points_.items[k]];
  chunks_.push_back(0);
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    if (points_.first[k + 1] - points_.first[chunks_.back()] >= points_per_chunk || k + 1 == cells_.size()) {
      chunks_.push_back(static_cast<std::int32_t>(k + 1));
    }
  }
}

std::vector<std::int32_t> Transfer::first_points() const {
  std::vector<std::int32_t> result;
  for (const std::int32_t cell : chunks_) result.push_back(points_.first[cell]);
  return result;
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

// In a complete cell the parts of the linked interpolation sum up, with e.g. w = theta, to
//   u_x = bilinear(U_x) - h_y/2 t (1 - t) (w_below - w_above),   u_y = bilinear(U_y) + h_x/2 s (1 - s) (w_left - w_right)
// with w linear along each side.

void Transfer::restrict_chunk(std::size_t chunk, const Quad* points, QuadVector& cells) const {
  const auto half_x = 0.5F * static_cast<float>(grid_.spacing().x),
             half_y = 0.5F * static_cast<float>(grid_.spacing().y);
  for (std::int32_t k = chunks_[chunk]; k < chunks_[chunk + 1]; ++k) {
    const std::int32_t cell = cells_[k];
    Quad sum[4] = {};
    const bool full = grid_.full(cell);
    for (std::int32_t point = points_.first[k]; point < points_.first[k + 1]; ++point) {
      const auto [s, t] = inside_[point];
      const Quad force = points[point];
      if (full) {
        const float across = half_y * t * (1 - t) * force[0], along = half_x * s * (1 - s) * force[1];
        const Quad below = (1 - t) * force, above = t * force;
        sum[0] += (1 - s) * below + Quad{0, 0, (1 - t) * along - (1 - s) * across, 0};
        sum[1] += s * below + Quad{0, 0, -(1 - t) * along - s * across, 0};
        sum[2] += (1 - s) * above + Quad{0, 0, t * along + (1 - s) * across, 0};
        sum[3] += s * above + Quad{0, 0, s * across - t * along, 0};
        continue;
      }
      const auto corners = corners_at(grid_, cell, s, t);
      for (std::size_t e = 0; e < 4; ++e) {
        const auto& [weight, turn] = corners[e];
        sum[e] += weight * (force + Quad{0, 0, force[0] * turn[0] + force[1] * turn[1], 0});
      }
    }
    std::copy(sum, sum + 4, &cells[4 * static_cast<std::size_t>(cell)]);
  }
}

void Transfer::add_up_corners(const QuadVector& cells, QuadVector& nodes) const {
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

void Transfer::add_motions(std::size_t chunk, const QuadVector& nodes, Quad* points) const {
  const auto half_x = 0.5F * static_cast<float>(grid_.spacing().x),
             half_y = 0.5F * static_cast<float>(grid_.spacing().y);
  for (std::int32_t k = chunks_[chunk]; k < chunks_[chunk + 1]; ++k) {
    const std::int32_t cell = cells_[k];
    Quad motion[4];
    for (int e = 0; e < 4; ++e) motion[e] = corners_[cell][e] >= 0 ? nodes[corners_[cell][e]] : Quad{};
    const bool full = grid_.full(cell);
    for (std::int32_t point = points_.first[k]; point < points_.first[k + 1]; ++point) {
      const auto [s, t] = inside_[point];
      if (full) {
        const Quad below = motion[0] + s * (motion[1] - motion[0]), above = motion[2] + s * (motion[3] - motion[2]);
        const float left = motion[0][2] + t * (motion[2][2] - motion[0][2]);
        const float right = motion[1][2] + t * (motion[3][2] - motion[1][2]);
        points[point] += below + t * (above - below) + Quad{half_y * t * (1 - t) * (above[2] - below[2]),
                                                            half_x * s * (1 - s) * (left - right), 0, 0};
        continue;
      }
      const auto corners = corners_at(grid_, cell, s, t);
      for (std::size_t e = 0; e < 4; ++e) {
        points[point] += corners[e].weight * (motion[e] + motion[e][2] * corners[e].turn);
      }
    }
  }
}

double Transfer::bytes() const {
  return 12.0 * static_cast<double>(points_.items.size()) + 24.0 * static_cast<double>(corners_.size()) +
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
