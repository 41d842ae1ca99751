// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rectangular grids over an assembly, whose nodes carry rigid motions: a partition of unity (Melenk & Babuska 1996).
///
/// A node J carries a translation U_J and a rotation w_J (times a, as all rotations). Bilinear functions phi_J make of
/// them the motion of a point x, with arms d_J = (x - X_J) / a:
///
///   u = sum phi_J (U_J + w_J e_z x d_J / 2),   a theta = sum phi_J w_J
///
/// Rigid motions are exact for any factor of the arm, since sum phi_J X_J = x; with 1/2 pure bending is exact as well
/// (u_x = -xy, u_y = x²/2, theta = x), as in the linked interpolation of beams, so that cells do not lock.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/core/vector.hpp"

namespace equidem::multigrid {

/// One direction of a grid; lengths over a.
struct GridAxis {
  double low = 0;      ///< the first node
  double spacing = 1;  ///< of nodes
  int cells = 1;
  bool periodic = false;

  [[nodiscard]] int nodes() const { return periodic ? cells : cells + 1; }
};

/// From `low` over `extent`, with cells of about `spacing` whose number can be halved down to one of 8 to 15.
GridAxis divide(double low, double extent, double spacing, bool periodic);

/// A point by its place in a cell: 0 <= s, t <= 1, in spacings; beyond that where the cell's functions are continued.
struct Place {
  std::int32_t cell = 0;
  double s = 0, t = 0;
};

/// The functions of the four nodes of a cell at a point.
struct Shape {
  std::array<double, 4> weight{};  ///< phi_J of the nodes (0, 0), (1, 0), (0, 1), (1, 1); 0 where not kept
  std::array<Vec2, 4> arm{};       ///< d_J times its factor
};

class Grid {
 public:
  Grid(GridAxis x, GridAxis y);

  /// The grid on which two by two cells are one.
  [[nodiscard]] Grid coarser() const;
  /// Whether both numbers of cells can be halved and leave 8 or more.
  [[nodiscard]] bool divisible() const;
  /// Keep the nodes that stand for enough discs.
  /// \param mass per node, sum phi_J over the discs
  void keep_nodes(std::span<const double> mass);

  [[nodiscard]] std::size_t cells() const { return static_cast<std::size_t>(x_.cells) * y_.cells; }
  [[nodiscard]] std::size_t nodes() const { return kept_.size(); }
  [[nodiscard]] bool kept(std::size_t node) const { return kept_[node] != 0; }
  /// Whether the four nodes of a cell are kept.
  [[nodiscard]] bool full(std::size_t cell) const { return full_[cell] != 0; }
  /// All cells, line by line across the longer side; where that is periodic, from its two ends in turn, so that the
  /// neighbours of a line are never more than two lines away.
  [[nodiscard]] std::vector<std::int32_t> cell_order() const;
  [[nodiscard]] std::array<std::size_t, 4> nodes_of(std::size_t cell) const;
  [[nodiscard]] Vec2 position(std::size_t node) const;
  [[nodiscard]] Vec2 spacing() const { return {x_.spacing, y_.spacing}; }
  /// Whether there are more cells along x than along y.
  [[nodiscard]] bool wide() const { return x_.cells > y_.cells; }
  [[nodiscard]] int columns() const { return x_.nodes(); }

  /// The cell that contains a point (over a); points beyond a free side belong to the cells along it.
  [[nodiscard]] Place place(Vec2 point) const;
  /// The place of a point, of its nearest image where the grid is periodic, seen from a given cell.
  [[nodiscard]] Place place_in(std::int32_t cell, Vec2 point) const;
  /// Places a point in the cell whose functions move it: its own where that is full, else the nearest full one around
  /// it, else its own.
  [[nodiscard]] Place host(const Place& place) const;
  /// Bilinear functions where the cell is full, continued beyond it; else those of the kept nodes, scaled to add up to
  /// 1, with arms that keep rigid motions exact.
  [[nodiscard]] Shape shape(const Place& place) const;

 private:
  GridAxis x_, y_;
  std::vector<std::uint8_t> kept_;  // per node
  std::vector<std::uint8_t> full_;  // per cell
};

/// The rectangle that a grid has to cover, and the sizes that its spacing follows from.
struct GridRegion {
  Vec2 low, high;         ///< m: corners of the rectangle around the centres, or of the cell
  bool periodic = false;  ///< along both axes
  double discs = 0;
  double distance = 0;  ///< m, of the centres of discs in contact, mean
  double unit = 1;      ///< m: a, the length of rotations
};

/// \param spacing of the nodes over the distance; larger where pieces lie far apart: no more cells than discs
Grid grid_over(const GridRegion& region, double spacing);

/// Items sorted by a number that each has, for example points by their cell; items with the same number keep their
/// order.
struct Buckets {
  std::vector<std::int32_t> first;  ///< buckets + 1
  std::vector<std::int32_t> items;

  [[nodiscard]] std::span<const std::int32_t> of(std::size_t bucket) const {
    return {items.data() + first[bucket], items.data() + first[bucket + 1]};
  }
};

Buckets sort_into_buckets(std::span<const std::int32_t> bucket_of_item, std::size_t buckets);

}  // namespace equidem::multigrid
