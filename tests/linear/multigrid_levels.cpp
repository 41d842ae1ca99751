// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The parts of the multigrid cycle, each against what it stands for.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/linear/multigrid/block_matrix.hpp"
#include "equidem/linear/multigrid/grouped_rows.hpp"
#include "equidem/linear/multigrid/transfer.hpp"

#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::multigrid;

namespace {

constexpr float rounding = 1e-5F;

/// (u_x, u_y, a theta) at a point, lengths over a.
using Motion = std::function<std::array<double, 3>(Vec2)>;

std::vector<Motion> rigid_motions() {
  return {[](Vec2) {
            return std::array{1.0, 0.0, 0.0};
          },
          [](Vec2) {
            return std::array{0.0, 1.0, 0.0};
          },
          [](Vec2 x) {
            return std::array{-0.1 * x.y, 0.1 * x.x, 0.1};
          }};
}
/// Pure bending along x and along y.
std::vector<Motion> bendings() {
  return {[](Vec2 x) {
            return std::array{-0.01 * x.x * x.y, 0.005 * x.x * x.x, 0.01 * x.x};
          },
          [](Vec2 x) {
            return std::array{-0.005 * x.y * x.y, 0.01 * x.x * x.y, 0.01 * x.y};
          }};
}

Quad as_quad(const std::array<double, 3>& m) {
  return Quad{static_cast<float>(m[0]), static_cast<float>(m[1]), static_cast<float>(m[2]), 0};
}

QuadVector on_nodes(const Grid& grid, const Motion& motion) {
  QuadVector nodes;
  for (std::size_t node = 0; node < grid.nodes(); ++node) {
    if (grid.kept(node)) nodes.push_back(as_quad(motion(grid.position(node))));
  }
  return nodes;
}

void number_in_place(Transfer& transfer, const Grid& grid) {
  std::vector<std::int32_t> order;
  for (std::size_t node = 0; node < grid.nodes(); ++node) {
    if (grid.kept(node)) order.push_back(static_cast<std::int32_t>(order.size()));
  }
  transfer.number_nodes(order);
}

void add_motions(const Transfer& transfer, const QuadVector& nodes, QuadVector& points) {
  for (std::size_t chunk = 0; chunk < transfer.chunks(); ++chunk) transfer.add_motions(chunk, nodes, points.data());
}

Grid plain_grid() {
  return {{.low = -3, .spacing = 2, .cells = 6}, {.low = 1, .spacing = 1.5, .cells = 5}};
}

std::vector<Vec2> random_points(std::size_t count) {
  Random random(3);
  std::vector<Vec2> points(count);
  for (Vec2& x : points) x = {random.uniform(-3, 9), random.uniform(1, 8.5)};
  return points;
}

/// Largest difference of the motion that nodes give to the points from the motion itself.
double largest_miss(const Grid& grid, const std::vector<Vec2>& points, const Motion& motion) {
  std::vector<Place> places;
  for (const Vec2 x : points) places.push_back(grid.place(x));
  Transfer transfer(grid, places);
  number_in_place(transfer, grid);
  QuadVector moved(points.size(), Quad{});
  add_motions(transfer, on_nodes(grid, motion), moved);
  double miss = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto wanted = motion(points[transfer.order()[k]]);
    for (int e = 0; e < 3; ++e) miss = std::max(miss, std::abs(moved[k][e] - wanted[e]));
  }
  return miss;
}

GroupedRows grouped(const BlockMatrix& matrix) {
  const std::vector<std::int32_t> one_chunk{0, static_cast<std::int32_t>(matrix.rows())};
  return {matrix, one_chunk};
}

}  // namespace

TEST_CASE("nodes_give_points_rigid_motions_and_pure_bending_exactly") {
  Grid grid = plain_grid();
  const std::vector<Vec2> points = random_points(300);
  grid.keep_nodes(std::vector<double>(grid.nodes(), 1.0));
  for (const Motion& motion : rigid_motions()) CHECK(largest_miss(grid, points, motion) < rounding);
  for (const Motion& motion : bendings()) CHECK(largest_miss(grid, points, motion) < rounding);
}

TEST_CASE("envelope_cholesky_solves_and_holds_what_has_no_stiffness") {
  constexpr std::size_t rows = 12;
  BlockMatrix matrix;
  Block soft{}, coupling{};
  for (int e = 0; e < 3; ++e) {
    soft[4 * e] = e == 1 ? 0 : 2.5;  // the second component of every row has no stiffness
    coupling[4 * e] = e == 1 ? 0 : -1;
  }
  matrix.first.push_back(0);
  for (std::size_t row = 0; row < rows; ++row) matrix.first.push_back(matrix.first.back() + 3);
  matrix.resize();
  for (std::size_t row = 0; row < rows; ++row) {
    matrix.set(matrix.first[row], row, soft);
    matrix.set(matrix.first[row] + 1, (row + 1) % rows, coupling);  // a ring
    matrix.set(matrix.first[row] + 2, (row + rows - 1) % rows, coupling);
    matrix.set_inverse(row, soft);
  }
  QuadVector b(rows), x(rows), left(rows);
  for (std::size_t row = 0; row < rows; ++row) b[row] = Quad{static_cast<float>(row), 0, 1, 0};
  EnvelopeCholesky(matrix).solve(b, x);
  residual(grouped(matrix), b, x, left);
  for (std::size_t row = 0; row < rows; ++row) {
    CHECK(x[row][1] == 0);
    for (int e = 0; e < 3; ++e) CHECK(std::abs(left[row][e]) < rounding);
  }
}
