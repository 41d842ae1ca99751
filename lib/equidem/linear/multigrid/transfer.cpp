// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/transfer.hpp"

#include <algorithm>
#include <array>

#include "equidem/core/threads.hpp"

namespace equidem::multigrid {
namespace {

constexpr std::size_t points_per_task = 1 << 13;
/// Fewer on small levels, whose chunks still go round to several threads.
std::int32_t points_per_chunk(std::size_t points) {
  return std::clamp(static_cast<std::int32_t>(points >> 7), 1 << 6, 1 << 10);
}

/// The motion of a point is sum w_k (U_k + a theta_k turn_k) over the corners k.
struct Corner {
  float weight;
  Quad turn;
};

std::array<Corner, 4> corners_at(const Grid& grid, std::int32_t cell, Inside point) {
  const Shape shape = grid.shape({cell, point.s, point.t});
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
  const std::int32_t at_once = points_per_chunk(places.size());
  chunks_.push_back(0);
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    if (points_.first[k + 1] - points_.first[chunks_.back()] >= at_once || k + 1 == cells_.size()) {
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

PointsOfCell Transfer::points_of(std::size_t place) const {
  const auto first = static_cast<std::size_t>(points_.first[place]);
  return {.inside = inside_.data() + first,
          .count = static_cast<std::size_t>(points_.first[place + 1]) - first,
          .half_x = 0.5F * static_cast<float>(grid_.spacing().x),
          .half_y = 0.5F * static_cast<float>(grid_.spacing().y)};
}

void Transfer::restrict_chunk(std::size_t chunk, const Quad* points, QuadVector& cells) const {
  for (std::int32_t k = chunks_[chunk]; k < chunks_[chunk + 1]; ++k) {
    const std::int32_t cell = cells_[k];
    const PointsOfCell here = points_of(k);
    const Quad* forces = points + points_.first[k];
    Quad* corners = &cells[4 * static_cast<std::size_t>(cell)];
    if (grid_.full(cell)) {
      grid_functions().restrict_cell(here, forces, corners);
      continue;
    }
    std::fill(corners, corners + 4, Quad{});
    for (std::size_t point = 0; point < here.count; ++point) {
      const Quad force = forces[point];
      const auto shares = corners_at(grid_, cell, here.inside[point]);
      for (std::size_t e = 0; e < 4; ++e) {
        const auto& [weight, turn] = shares[e];
        corners[e] += weight * (force + Quad{0, 0, force[0] * turn[0] + force[1] * turn[1], 0});
      }
    }
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
  for (std::int32_t k = chunks_[chunk]; k < chunks_[chunk + 1]; ++k) {
    const std::int32_t cell = cells_[k];
    const PointsOfCell here = points_of(k);
    Quad* motions = points + points_.first[k];
    Quad corners[4];
    for (int e = 0; e < 4; ++e) corners[e] = corners_[cell][e] >= 0 ? nodes[corners_[cell][e]] : Quad{};
    if (grid_.full(cell)) {
      grid_functions().move_points(here, corners, motions);
      continue;
    }
    for (std::size_t point = 0; point < here.count; ++point) {
      const auto shares = corners_at(grid_, cell, here.inside[point]);
      for (std::size_t e = 0; e < 4; ++e) {
        motions[point] += shares[e].weight * (corners[e] + corners[e][2] * shares[e].turn);
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
