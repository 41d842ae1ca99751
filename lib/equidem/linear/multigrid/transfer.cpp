// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/transfer.hpp"

#include <algorithm>
#include <array>

#include "equidem/contact/frame.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multigrid/kernels/grid_kernel.hpp"

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

namespace {

constexpr std::size_t cells_at_once = 1 << 7;
constexpr std::size_t contacts_at_once = 1 << 13;
constexpr std::size_t nodes_at_once = 1 << 10;
constexpr int cell_unknowns = 12;  // unknowns of a cell

using CellVector = std::array<double, cell_unknowns>;

/// The middle of a contact, over a.
Vec2 midpoint(const Assembly& assembly, const Contact& contact, double a) {
  return (1 / a) * (assembly.centres[contact.i] + 0.5 * assembly.branch(contact));
}

/// derivative += that of a deformation by the unknowns of the cell, from that by the motion of one disc.
void add_derivative(const Shape& shape, const std::array<double, 3>& of_disc, bool rotations, CellVector& derivative) {
  const auto [x, y, turn] = of_disc;
  for (int k = 0; k < 4; ++k) {
    const double weight = shape.weight[k];
    const Vec2 arm = shape.arm[k];
    derivative[3 * k] += weight * x;
    derivative[3 * k + 1] += weight * y;
    if (rotations) derivative[3 * k + 2] += weight * (turn + arm.x * y - arm.y * x);
  }
}

/// \param unit Pa, by which springs are divided
void add_contact(const Grid& grid, std::int32_t cell, const SpringNetwork& network, std::size_t c, double unit,
                 double* matrix) {
  const auto& [assembly, graph, springs, unknowns] = network;
  const Contact& contact = assembly.contacts[c];
  const double a = unknowns.rotation_scale;
  const Place middle = grid.place_in(cell, midpoint(assembly, contact, a));
  const Vec2 half = (0.5 / a) * assembly.branch(contact);
  const double s = half.x / grid.spacing().x, t = half.y / grid.spacing().y;
  ContactStiffness k = contact_stiffness(springs, c, frame_of(assembly, c), a);
  k.divide(unit);
  const bool turns = unknowns.per_disc == 3;
  hold_end(unknowns, contact.i, k.ends.i);
  hold_end(unknowns, contact.j, k.ends.j);
  const Shape of_i = grid.shape({middle.cell, middle.s - s, middle.t - t}),
              of_j = grid.shape({middle.cell, middle.s + s, middle.t + t});
  const auto derivative = [&](const std::array<double, 3>& by_i, const std::array<double, 3>& by_j) {
    CellVector sum{};
    add_derivative(of_i, by_i, turns, sum);
    add_derivative(of_j, by_j, turns, sum);
    return sum;
  };
  const CellVector normal = derivative(k.ends.i.normal, k.ends.j.normal),
                   tangential = derivative(k.ends.i.tangential, k.ends.j.tangential);
  grid_functions().add_squares(k.kN, normal.data(), k.kT, tangential.data(), matrix);
  if (k.kM == 0 || !turns) return;
  const CellVector bending = derivative({0, 0, k.ends.i.bending()}, {0, 0, k.ends.j.bending()});
  grid_functions().add_squares(k.kM, bending.data(), 0, bending.data(), matrix);
}

/// The motion of a node by the unknowns of a coarser cell, 3 x 12.
void set_motion_of_node(const Shape& shape, double* motion) {
  for (int k = 0; k < 4; ++k) {
    for (int e = 0; e < 3; ++e) motion[e * cell_unknowns + 3 * k + e] = shape.weight[k];
    motion[3 * k + 2] = -shape.weight[k] * shape.arm[k].y;
    motion[cell_unknowns + 3 * k + 2] = shape.weight[k] * shape.arm[k].x;
  }
}

/// The columns of a row, that of the diagonal first.
class RowColumns {
 public:
  /// \param found(entry, place, corner) is called for every corner of the cells around the node
  template <typename Found>
  RowColumns(const Transfer& numbering, std::size_t node, const Found& found) {
    columns_[entries_++] = static_cast<std::int32_t>(node);
    for (const std::int32_t place : numbering.adjacent(node)) {
      if (place < 0) continue;
      const auto& corners = numbering.corners(static_cast<std::size_t>(place / 4));
      for (int k = 0; k < 4; ++k) {
        if (corners[k] >= 0) found(entry_of(corners[k]), place, k);
      }
    }
  }
  [[nodiscard]] std::span<const std::int32_t> get() const { return {columns_.data(), entries_}; }

 private:
  std::size_t entry_of(std::int32_t column) {
    std::size_t e = 0;
    while (e < entries_ && columns_[e] != column) ++e;
    if (e == entries_) columns_[entries_++] = column;
    return e;
  }

  std::array<std::int32_t, 16> columns_{};
  std::size_t entries_ = 0;
};

}  // namespace

CellStiffness stiffness_of_contacts(const Grid& grid, const SpringNetwork& network, double unit) {
  const Assembly& assembly = network.assembly;
  std::vector<std::int32_t> cell(assembly.contacts.size());
  parallel_ranges(cell.size(), contacts_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Vec2 middle = midpoint(assembly, assembly.contacts[c], network.unknowns.rotation_scale);
      cell[c] = grid.host(grid.place(middle)).cell;
    }
  });
  const Buckets contacts = sort_into_buckets(cell, grid.cells());
  CellStiffness result(grid.cells() * cell_unknowns * cell_unknowns);
  parallel_ranges(grid.cells(), cells_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      double sum[cell_unknowns * cell_unknowns] = {};
      for (const std::int32_t c : contacts.of(k))
        add_contact(grid, static_cast<std::int32_t>(k), network, static_cast<std::size_t>(c), unit, sum);
      std::copy(sum, sum + cell_unknowns * cell_unknowns, &result[k * cell_unknowns * cell_unknowns]);
    }
  });
  return result;
}

CellStiffness stiffness_on_coarser(const Grid& coarse, const Grid& fine, const CellStiffness& cells) {
  const auto middle_of = [&](std::size_t cell) {
    return coarse.host(coarse.place(fine.position(fine.nodes_of(cell)[0]) + 0.5 * fine.spacing()));
  };
  std::vector<std::int32_t> parent(fine.cells());
  for (std::size_t k = 0; k < parent.size(); ++k) parent[k] = middle_of(k).cell;
  const Buckets children = sort_into_buckets(parent, coarse.cells());
  CellStiffness result(coarse.cells() * cell_unknowns * cell_unknowns);
  parallel_ranges(coarse.cells(), cells_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      double sum[cell_unknowns * cell_unknowns] = {};
      for (const std::int32_t child : children.of(k)) {
        const Place middle = middle_of(child);
        double motion[cell_unknowns * cell_unknowns] = {};  // of the four nodes of the child
        for (int corner = 0; corner < 4; ++corner) {        // a quarter of the coarse spacing from the middle
          set_motion_of_node(
              coarse.shape({middle.cell, middle.s + 0.5 * (corner % 2) - 0.25, middle.t + 0.5 * (corner / 2) - 0.25}),
              motion + 3 * corner * cell_unknowns);
        }
        grid_functions().add_projection(&cells[static_cast<std::size_t>(child) * cell_unknowns * cell_unknowns], motion,
                                        sum);
      }
      std::copy(sum, sum + cell_unknowns * cell_unknowns, &result[k * cell_unknowns * cell_unknowns]);
    }
  });
  return result;
}

BlockMatrix assemble_cells(const Transfer& numbering, const CellStiffness& cells) {
  BlockMatrix matrix;
  const std::size_t n = numbering.unknowns();
  matrix.first.assign(n + 1, 0);
  parallel_ranges(n, nodes_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      const RowColumns columns(numbering, node, [](std::size_t, std::int32_t, int) {});
      matrix.first[node + 1] = static_cast<std::int64_t>(columns.get().size());
    }
  });
  for (std::size_t node = 0; node < n; ++node) matrix.first[node + 1] += matrix.first[node];
  matrix.resize();
  parallel_ranges(n, nodes_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      std::array<Block, 16> blocks{};
      const RowColumns row(numbering, node, [&](std::size_t entry, std::int32_t place, int corner) {
        const double* block = &cells[static_cast<std::size_t>(place / 4) * cell_unknowns * cell_unknowns +
                                     static_cast<std::size_t>(place % 4 * 3 * cell_unknowns + 3 * corner)];
        for (int k = 0; k < 9; ++k) blocks[entry][k] += block[k / 3 * cell_unknowns + k % 3];
      });
      const auto columns = row.get();
      for (std::size_t e = 0; e < columns.size(); ++e) {
        matrix.set(matrix.first[node] + static_cast<std::int64_t>(e), static_cast<std::size_t>(columns[e]), blocks[e]);
      }
      matrix.set_inverse(node, blocks[0]);
    }
  });
  return matrix;
}

}  // namespace equidem::multigrid
