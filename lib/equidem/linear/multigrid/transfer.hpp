// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Motions and forces between the points of one level and the nodes of the grid above it.
/// Stiffness matrices of the cells of a grid. The energy of a contact goes into the one cell that holds its midpoint,
/// whose functions move both of its discs: the matrix on the nodes is positive semidefinite and couples a node to the
/// eight around it only, where the exact projection of K would couple 22.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multigrid/block_matrix.hpp"
#include "equidem/linear/multigrid/grid.hpp"
#include "equidem/linear/multigrid/kernels/grid_kernel.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem::multigrid {

/// Points are sorted by their host cell, so that a cell reads one run of them and four nodes. Cells follow one another
/// along the shorter side of the grid (Grid::cell_order), so that neighbours are not far apart in memory.
class Transfer {
 public:
  /// \param grid must outlive this object
  /// \param places of the points
  Transfer(const Grid& grid, std::span<const Place> places);
  /// The point that stands k-th on the finer level.
  [[nodiscard]] const std::vector<std::int32_t>& order() const { return points_.items; }
  /// The points in chunks of whole cells: the first point of each chunk, and their number at the end.
  [[nodiscard]] std::vector<std::int32_t> first_points() const;
  /// Number the nodes that are kept.
  /// \param order of the kept nodes, as indices among them
  void number_nodes(std::span<const std::int32_t> order);
  [[nodiscard]] std::size_t unknowns() const { return adjacent_.size(); }
  /// The nodes of a cell by their numbers; -1: not kept.
  [[nodiscard]] const std::array<std::int32_t, 4>& corners(std::size_t cell) const { return corners_[cell]; }
  /// 4 cell + corner for each of the (at most) four cells around a node; -1: none.
  [[nodiscard]] const std::array<std::int32_t, 4>& adjacent(std::size_t node) const { return adjacent_[node]; }

  /// Forces on the nodes, of the same work as those on the points: first on the corners of the cells of each chunk,
  /// then on the nodes.
  /// \param cells corners of each cell
  void restrict_chunk(std::size_t chunk, const Quad* points, QuadVector& cells) const;
  void add_up_corners(const QuadVector& cells, QuadVector& nodes) const;
  /// points += the motions that the nodes give those of the chunk.
  void add_motions(std::size_t chunk, const QuadVector& nodes, Quad* points) const;
  [[nodiscard]] std::size_t chunks() const { return chunks_.size() - 1; }
  [[nodiscard]] std::size_t cells() const { return cells_.size(); }
  [[nodiscard]] double bytes() const;

 private:
  [[nodiscard]] PointsOfCell points_of(std::size_t place) const;

  const Grid& grid_;
  std::vector<std::int32_t> cells_;   // in the order in which they follow one another
  Buckets points_;                    // by host cell, in that order
  std::vector<std::int32_t> chunks_;  // first place in cells_ of each, and their number at the end
  std::vector<Inside> inside_;        // per point, sorted
  std::vector<std::array<std::int32_t, 4>> corners_, adjacent_;
};

/// The unknown nodes in the order in which they are found along the longer side of the grid, as Transfer::number_nodes
/// takes them: factors of matrices on the grid are then narrow.
std::vector<std::int32_t> order_along(const Grid& grid);

/// Computes the weight of each node: the sum of its functions over points of a given mass.
std::vector<double> node_masses(const Grid& grid, std::span<const Place> places, std::span<const double> masses);

/// 12 x 12 entries per cell: four nodes of three unknowns.
using CellStiffness = LargeVector<double>;

/// \param unit Pa, by which springs are divided
CellStiffness stiffness_of_contacts(const Grid& grid, const SpringNetwork& network, double unit);
/// Projects the energies of the cells of a fine grid: its nodes are moved by the functions of the cells of `coarse`.
CellStiffness stiffness_on_coarser(const Grid& coarse, const Grid& fine, const CellStiffness& cells);

/// The matrix on the numbered nodes of the grid.
BlockMatrix assemble_cells(const Transfer& numbering, const CellStiffness& cells);

}  // namespace equidem::multigrid
