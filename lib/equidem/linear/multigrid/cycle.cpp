// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/cycle.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "equidem/core/threads.hpp"
#include "equidem/linear/multigrid/cell_stiffness.hpp"

namespace equidem::multigrid {
namespace {

constexpr std::size_t discs_per_task = 1 << 13;

Grid grid_over(const Assembly& assembly, double a, double spacing) {
  double sum = 0;
  for (const Contact& contact : assembly.contacts) sum += norm(assembly.branch(contact));
  const bool periodic = assembly.periodic();
  Vec2 low = periodic ? Vec2{} : assembly.centres.front(), high = periodic ? *assembly.period : low;
  for (const Vec2 x : assembly.centres) {
    if (periodic) break;
    low = {std::min(low.x, x.x), std::min(low.y, x.y)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y)};
  }
  const Vec2 extent = (1 / a) * (high - low);
  const auto discs = static_cast<double>(assembly.size());
  // Pieces far apart: no more cells than discs.
  const double h = std::max({spacing * sum / static_cast<double>(assembly.contacts.size()) / a,
                             std::sqrt(extent.x) * std::sqrt(extent.y / discs), extent.x / discs, extent.y / discs});
  return {divide(low.x / a, extent.x, h, periodic), divide(low.y / a, extent.y, h, periodic)};
}

/// The block of a disc or a contact over `unit`, filled up with zeros, which held components have as well.
Block scaled_block(const double* block, int b, double unit, bool transposed) {
  Block result{};
  for (int r = 0; r < b; ++r) {
    for (int c = 0; c < b; ++c) result[3 * r + c] = (transposed ? block[c * b + r] : block[r * b + c]) / unit;
  }
  return result;
}

BlockMatrix matrix_of_discs(const MatrixOnGraph& k, const DegreesOfFreedom& unknowns,
                            const std::vector<std::int32_t>& order, double unit) {
  const std::size_t n = order.size();
  const int b = k.matrix.block;
  std::vector<std::int32_t> row_of(n);
  BlockMatrix result;
  result.first.assign(n + 1, 0);
  for (std::size_t row = 0; row < n; ++row) {
    row_of[order[row]] = static_cast<std::int32_t>(row);
    result.first[row + 1] = result.first[row] + 1 + static_cast<std::int64_t>(k.graph.of(order[row]).size());
  }
  result.resize();
  parallel_ranges(n, discs_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const std::int32_t disc = order[row];
      std::int64_t entry = result.first[row];
      Block diagonal = scaled_block(k.matrix.diagonal_block(disc), b, unit, false);
      for (int e = 0; e < b; ++e) {
        if (unknowns.held[static_cast<std::size_t>(disc) * b + e] != 0) diagonal[4 * e] = 0;
      }
      result.set(entry++, row, diagonal);
      result.set_inverse(row, diagonal);
      for (const auto& edge : k.graph.of(disc)) {
        const bool transposed = k.assembly.contacts[edge.contact].i != disc;
        result.set(entry++, row_of[edge.other],
                   scaled_block(k.matrix.coupling_block(edge.contact), b, unit, transposed));
      }
    }
  });
  return result;
}

std::vector<std::int32_t> numbers_up_to(std::size_t n) {
  std::vector<std::int32_t> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

}  // namespace

Cycle::Cycle(const MatrixOnGraph& k, const ContactSprings& springs, const DegreesOfFreedom& unknowns,
             const CycleOptions& options)
    : unknowns_(unknowns) {
  const double unit = springs.largest();
  levels_.emplace_back();
  if (k.assembly.size() < static_cast<std::size_t>(options.direct_below)) {
    order_ = numbers_up_to(k.assembly.size());
  } else {
    build_grids(k, springs, options);
    order_ = levels_[0].transfer->order();
  }
  levels_[0].matrix = matrix_of_discs(k, unknowns, order_, unit);
  // (q_i + q_j)² <= 2 q_i² + 2 q_j² in the energy of every contact: no eigenvalue of D^-1 K exceeds 2.
  levels_[0].smoother = {.degree = options.degree, .largest = 2, .range = options.range};
  for (Level& level : levels_) {
    const std::size_t n = level.matrix.rows();
    for (QuadVector* vector : {&level.b, &level.x, &level.step, &level.next}) vector->resize(n);
    std::fill(level.x.begin(), level.x.end(), Quad{});
  }
  coarsest_ = EnvelopeCholesky(levels_.back().matrix);
}

void Cycle::build_grids(const MatrixOnGraph& k, const ContactSprings& springs, const CycleOptions& options) {
  const double a = unknowns_.rotation_scale;
  const auto b = static_cast<std::size_t>(k.matrix.block);
  auto grid = std::make_unique<Grid>(grid_over(k.assembly, a, options.spacing));
  std::vector<Place> places(k.assembly.size());
  std::vector<double> masses(places.size());
  for (std::size_t d = 0; d < places.size(); ++d) {
    places[d] = grid->place((1 / a) * k.assembly.centres[d]);
    const auto held = unknowns_.held.begin() + static_cast<std::ptrdiff_t>(d * b);
    masses[d] = std::all_of(held, held + 2, [](std::uint8_t h) { return h != 0; }) ? 0 : 1;
  }
  masses = node_masses(*grid, places, masses);
  grid->keep_nodes(masses);
  CellStiffness cells = stiffness_of_contacts(*grid, k.assembly, springs, unknowns_, springs.largest());
  for (double& entry : cells) entry *= options.coarse_factor;
  auto transfer = std::make_unique<Transfer>(*grid, places);
  while (transfer) {
    Level& level = levels_.back();
    level.grid = std::exchange(grid, nullptr);
    level.transfer = std::exchange(transfer, nullptr);
    const Grid& here = *level.grid;
    CellStiffness coarser_cells;
    if (here.divisible()) {
      grid = std::make_unique<Grid>(here.coarser());
      places.clear();
      std::vector<double> masses_of_kept;
      for (std::size_t node = 0; node < here.nodes(); ++node) {
        if (!here.kept(node)) continue;
        places.push_back(grid->place(here.position(node)));
        masses_of_kept.push_back(masses[node]);
      }
      masses = node_masses(*grid, places, masses_of_kept);
      grid->keep_nodes(masses);
      transfer = std::make_unique<Transfer>(*grid, places);
      coarser_cells = stiffness_on_coarser(*grid, here, cells);
    }
    level.transfer->number_nodes(transfer ? transfer->order() : order_along(here));
    BlockMatrix matrix = assemble_cells(*level.transfer, cells);
    constexpr int iterations = 10;
    constexpr double margin = 1.1;  // power iteration approaches from below
    const double largest = margin * largest_eigenvalue(matrix, iterations);
    levels_.push_back({.matrix = std::move(matrix),
                       .smoother = {.degree = options.degree, .largest = largest, .range = options.range}});
    cells = std::move(coarser_cells);
  }
}

void Cycle::correct(std::size_t number) {
  Level& level = levels_[number];
  if (number + 1 == levels_.size()) {
    coarsest_.solve(level.b, level.x);
    return;
  }
  Level& above = levels_[number + 1];
  level.smoother.apply(level.matrix, level.b, level.x, level.step, level.next, true);
  residual(level.matrix, level.b, level.x, level.next);
  level.transfer->restrict_forces(level.next, above.b, level.cells);
  correct(number + 1);
  level.transfer->add_motions(above.x, level.x);
  level.smoother.apply(level.matrix, level.b, level.x, level.step, level.next, false);
}

void Cycle::apply(std::span<const double> r, std::span<double> z) {
  double largest = 0;
  for (const double value : r) largest = std::max(largest, std::abs(value));
  if (largest == 0) largest = 1;
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  Level& discs = levels_[0];
  parallel_ranges(order_.size(), discs_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const std::size_t first = static_cast<std::size_t>(order_[row]) * b;
      Quad force{};
      for (std::size_t e = 0; e < b; ++e) {
        if (unknowns_.held[first + e] == 0) force[e] = static_cast<float>(r[first + e] / largest);
      }
      discs.b[row] = force;
    }
  });
  correct(0);
  parallel_ranges(order_.size(), discs_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const std::size_t first = static_cast<std::size_t>(order_[row]) * b;
      for (std::size_t e = 0; e < b; ++e) {
        z[first + e] = unknowns_.held[first + e] == 0 ? largest * discs.x[row][e] : 0;
      }
    }
  });
}

double Cycle::bytes() const {
  double sum = coarsest_.bytes() + 4.0 * static_cast<double>(order_.size());
  for (const Level& level : levels_) {
    sum += level.matrix.bytes() + 16.0 * static_cast<double>(4 * level.x.size() + level.cells.capacity());
    if (level.transfer) sum += level.transfer->bytes();
  }
  return sum;
}

}  // namespace equidem::multigrid
