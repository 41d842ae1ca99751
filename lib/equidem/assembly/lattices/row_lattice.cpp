// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/lattices/row_lattice.hpp"

#include <limits>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

void check_counts(const LatticeOptions& o, const RowPattern& pattern) {
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
  const std::int64_t discs = std::int64_t{o.columns} * o.rows;
  if (discs > std::numeric_limits<std::int32_t>::max()) {
    bad_input(fmt::format("{} columns and {} rows make {} discs", o.columns, o.rows, discs),
              fmt::format("at most {} can be numbered", std::numeric_limits<std::int32_t>::max()), "Ask for fewer");
  }
  require_memory(bytes_of_network(static_cast<double>(discs)),
                 fmt::format("an assembly of {} discs needs about", grouped(discs)));
}

/// A lattice under construction: the place of every row in the numbering of discs.
class LatticeBuilder {
 public:
  LatticeBuilder(const LatticeOptions& options, const RowPattern& pattern) : options_(options), pattern_(pattern) {}

  Assembly build() {
    place_discs();
    join_discs();
    assembly_.cell_areas.assign(assembly_.size(), pattern_.cell_area);
    assembly_.facet_lengths.assign(assembly_.contacts.size(), pattern_.facet_length);
    if (!options_.periodic) name_sides();
    return std::move(assembly_);
  }

 private:
  [[nodiscard]] bool shifted(int row) const { return pattern_.staggered && row % 2 != 0; }
  [[nodiscard]] int count(int row) const {
    return shifted(row) && !options_.periodic ? options_.columns - 1 : options_.columns;
  }
  /// Number of the first disc of a row.
  [[nodiscard]] std::int32_t first(int row) const {
    const int short_rows = pattern_.staggered && !options_.periodic ? row / 2 : 0;
    return options_.columns * row - short_rows;
  }

  void place_discs() {
    const double a = options_.radius;
    assembly_.kind = pattern_.kind;
    assembly_.centres.resize(static_cast<std::size_t>(first(options_.rows)));
    assembly_.radii.assign(assembly_.centres.size(), a);
    std::size_t disc = 0;
    for (int row = 0; row < options_.rows; ++row) {
      const double y = (row + 0.5) * pattern_.row_distance;
      for (int column = 0; column < count(row); ++column) {
        const double half_diameters = 2.0 * column + (shifted(row) ? 2 : 1);
        assembly_.centres[disc++] = {half_diameters * a, y};
      }
    }
    if (options_.periodic) assembly_.period = {2.0 * options_.columns * a, options_.rows * pattern_.row_distance};
  }

  /// Each disc brings its contacts to the right and to the next row, so that every contact is made once.
  void join_discs() {
    assembly_.contacts.reserve(assembly_.size() * (pattern_.staggered ? 3 : 2));
    for (int row = 0; row < options_.rows; ++row) {
      // Columns of the two upper neighbours of a staggered row, relative to this column.
      const int upper = shifted(row) ? 0 : -1;
      for (int column = 0; column < count(row); ++column) {
        join(row, column, row, column + 1);
        if (!pattern_.staggered) {
          join(row, column, row + 1, column);
        } else {
          join(row, column, row + 1, column + upper);
          join(row, column, row + 1, column + upper + 1);
        }
      }
    }
  }

  void join(int row, int column, int other_row, int other_column) {
    Contact contact;
    if (options_.periodic) {
      if (other_row == options_.rows) other_row = 0, contact.shift_y = 1;
      if (other_column == options_.columns) other_column = 0, contact.shift_x = 1;
      if (other_column < 0) other_column = options_.columns - 1, contact.shift_x = -1;
    } else if (other_row == options_.rows || other_column < 0 || other_column >= count(other_row)) {
      return;
    }
    contact.i = first(row) + column;
    contact.j = first(other_row) + other_column;
    contact.lever_i = contact.lever_j = options_.radius;
    assembly_.contacts.push_back(contact);
  }

  void name_sides() {
    const int rows = options_.rows;
    auto& groups = assembly_.groups;
    for (int row = 0; row < rows; ++row) {
      groups["left"].discs.push_back(first(row));
      groups["right"].discs.push_back(first(row + 1) - 1);
    }
    for (std::int32_t disc = 0; disc < first(1); ++disc) groups["bottom"].discs.push_back(disc);
    for (std::int32_t disc = first(rows - 1); disc < first(rows); ++disc) groups["top"].discs.push_back(disc);
    for (const char* side : {"left", "right"}) {
      groups[side].tributary_lengths.assign(groups[side].discs.size(), pattern_.row_distance);
    }
    for (const char* side : {"bottom", "top"}) {
      groups[side].tributary_lengths.assign(groups[side].discs.size(), 2 * options_.radius);
    }
    groups["bottom_left"].discs = {0};
    groups["bottom_right"].discs = {first(1) - 1};
    groups["top_left"].discs = {first(rows - 1)};
    groups["top_right"].discs = {first(rows) - 1};
  }

  const LatticeOptions& options_;
  const RowPattern& pattern_;
  Assembly assembly_;
};

}  // namespace

Assembly row_lattice(const LatticeOptions& options, const RowPattern& pattern) {
  check_counts(options, pattern);
  return LatticeBuilder(options, pattern).build();
}

}  // namespace equidem
