// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/lattices/row_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

void check_numbers(const LatticeOptions& o) {
  const std::int64_t discs = std::int64_t{o.columns} * o.rows;
  if (discs <= std::numeric_limits<std::int32_t>::max()) return;
  bad_input(fmt::format("{} columns and {} rows make {} discs", o.columns, o.rows, discs),
            fmt::format("at most {} can be numbered", std::numeric_limits<std::int32_t>::max()), "Ask for fewer");
}

/// The block of rows along x that discs numbered row by row form.
LatticeOptions rows_of(const Assembly& assembly) {
  LatticeOptions block{.columns = 0, .rows = 0, .radius = assembly.radii.front(), .periodic = assembly.periodic()};
  double y = 0;
  for (const Vec2 centre : assembly.centres) {
    if (block.rows == 0 || std::abs(centre.y - y) > 1e-9 * block.radius) ++block.rows, y = centre.y;
    if (block.rows == 1) ++block.columns;
  }
  return block;
}

bool has_sides_of(const RowLattice& lattice, const Assembly& assembly) {
  const auto sides = row_lattice_sides(lattice);
  return std::ranges::all_of(std::array{"left", "right", "bottom"}, [&](const char* name) {
    const auto side = assembly.groups.find(name);
    return side != assembly.groups.end() && side->second.discs == sides.at(name).discs;
  });
}

}  // namespace

void check_row_lattice(const LatticeOptions& o, const RowPattern& pattern) {
  const bool staggered = pattern.staggered;
  if (o.columns < 1) {
    bad_input(fmt::format("columns = {}", o.columns), "a row of a lattice has at least one disc", "Ask for 1 or more");
  }
  if (o.rows < 1) {
    bad_input(fmt::format("rows = {}", o.rows), "a lattice has at least one row", "Ask for 1 or more");
  }
  if (!is_positive(o.radius)) {
    bad_input(fmt::format("radius = {} m", o.radius), "a radius must be positive and finite", "Correct it");
  }
  if (!measurable(o.radius)) bad_input(fmt::format("radius = {} m", o.radius), length_limits(), "Choose other units");
  if (staggered && o.periodic && o.rows % 2 != 0) {
    bad_input(fmt::format("rows = {} in a periodic {} lattice", o.rows, pattern.kind),
              "rows are shifted by turns, so that only an even number of them repeats",
              fmt::format("Ask for {} or {}", o.rows > 1 ? o.rows - 1 : 2, o.rows > 1 ? o.rows + 1 : 4));
  }
  if (staggered && !o.periodic && o.columns == 1 && o.rows > 1) {
    bad_input(fmt::format("columns = 1 in a free {} lattice", pattern.kind),
              "every other row has one disc less, here none, and the rows would not touch",
              "Ask for 2 or more columns");
  }
}

RowLattice::Neighbours RowLattice::neighbours(int row, int column) const {
  Neighbours found;
  const auto join = [&](int other_row, int other_column) {
    Neighbour other{other_row, other_column, 0, 0};
    if (options_.periodic) {
      if (other_row == options_.rows) other.row = 0, other.shift_y = 1;
      if (other_column == options_.columns) other.column = 0, other.shift_x = 1;
      if (other_column < 0) other.column = options_.columns - 1, other.shift_x = -1;
    } else if (other_row == options_.rows || other_column < 0 || other_column >= count(other_row)) {
      return;
    }
    found.of[static_cast<std::size_t>(found.count++)] = other;
  };
  join(row, column + 1);
  if (!pattern_.staggered) {
    join(row + 1, column);
  } else {
    const int upper = shifted(row) ? 0 : -1;  // the columns of the two upper neighbours, relative to this column
    join(row + 1, column + upper);
    join(row + 1, column + upper + 1);
  }
  return found;
}

std::map<std::string, DiscGroup> row_lattice_sides(const RowLattice& lattice) {
  const int rows = lattice.options().rows;
  check_numbers(lattice.options());
  const auto first = [&](int row) { return static_cast<std::int32_t>(lattice.first(row)); };
  std::map<std::string, DiscGroup> groups;
  for (int row = 0; row < rows; ++row) {
    groups["left"].discs.push_back(first(row));
    groups["right"].discs.push_back(first(row + 1) - 1);
  }
  for (std::int32_t disc = 0; disc < first(1); ++disc) groups["bottom"].discs.push_back(disc);
  for (std::int32_t disc = first(rows - 1); disc < first(rows); ++disc) groups["top"].discs.push_back(disc);
  for (const char* side : {"left", "right"}) {
    groups[side].tributary_lengths.assign(groups[side].discs.size(), lattice.pattern().row_distance);
  }
  for (const char* side : {"bottom", "top"}) {
    groups[side].tributary_lengths.assign(groups[side].discs.size(), 2 * lattice.options().radius);
  }
  groups["bottom_left"].discs = {0};
  groups["bottom_right"].discs = {first(1) - 1};
  groups["top_left"].discs = {first(rows - 1)};
  groups["top_right"].discs = {first(rows) - 1};
  return groups;
}

Assembly row_lattice(const LatticeOptions& options, const RowPattern& pattern) {
  check_row_lattice(options, pattern);
  check_numbers(options);
  const std::int64_t discs = std::int64_t{options.columns} * options.rows;
  require_memory(bytes_of_network(static_cast<double>(discs)),
                 fmt::format("an assembly of {} discs needs about", grouped(discs)));
  const RowLattice lattice(options, pattern);
  Assembly assembly;
  assembly.kind = pattern.kind;
  assembly.centres.reserve(static_cast<std::size_t>(lattice.first(options.rows)));
  assembly.contacts.reserve(assembly.centres.capacity() * (pattern.staggered ? 3 : 2));
  for (int row = 0; row < options.rows; ++row) {
    for (int column = 0; column < lattice.count(row); ++column) {
      const auto disc = static_cast<std::int32_t>(assembly.centres.size());
      assembly.centres.push_back(lattice.centre(row, column));
      const RowLattice::Neighbours near = lattice.neighbours(row, column);
      for (int k = 0; k < near.count; ++k) {
        const RowLattice::Neighbour& other = near.of[static_cast<std::size_t>(k)];
        assembly.contacts.push_back({.i = disc,
                                     .j = static_cast<std::int32_t>(lattice.first(other.row) + other.column),
                                     .shift_x = other.shift_x,
                                     .shift_y = other.shift_y,
                                     .lever_i = options.radius,
                                     .lever_j = options.radius});
      }
    }
  }
  assembly.radii.assign(assembly.size(), options.radius);
  assembly.cell_areas.assign(assembly.size(), pattern.cell_area);
  assembly.facet_lengths.assign(assembly.contacts.size(), pattern.facet_length);
  if (options.periodic) assembly.period = lattice.period();
  if (options.periodic) return assembly;
  assembly.groups = row_lattice_sides(lattice);
  // As large as all cells together: as wide as the rows in the mean.
  const double height = options.rows * pattern.row_distance, middle = options.columns * options.radius;
  const double half = 0.5 * static_cast<double>(assembly.size()) * pattern.cell_area / height;
  assembly.box = Rectangle{{middle - half, 0}, {middle + half, height}};
  return assembly;
}

bool is_row_lattice(const Assembly& assembly, const RowPattern& pattern) {
  const RowLattice lattice(rows_of(assembly), pattern);
  const auto [columns, rows, radius, periodic] = lattice.options();
  const double near = 1e-9 * radius;
  if (pattern.staggered && (periodic ? rows % 2 != 0 : columns < 2)) return false;
  if (lattice.first(rows) != static_cast<std::int64_t>(assembly.size())) return false;
  if (periodic && norm(lattice.period() - *assembly.period) > near) return false;
  if (std::ranges::any_of(assembly.radii, [&](double r) { return std::abs(r - radius) > near; })) return false;
  std::size_t disc = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < lattice.count(row); ++column, ++disc)
      if (norm(lattice.centre(row, column) - assembly.centres[disc]) > near) return false;
  return periodic || has_sides_of(lattice, assembly);
}

}  // namespace equidem
