// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"

#include "petsc/part.hpp"

namespace equidem::petsc {
namespace {

class BlockMaker {
 public:
  BlockMaker(const Ranks& ranks, const RowLattice& lattice) : lattice_(lattice), grid_(lattice, ranks.count()) {
    begin_.push_back(0);
    for (int rank = 0; rank < ranks.count(); ++rank) {
      const BlockGrid::Block block = grid_.block(rank);
      begin_.push_back(begin_.back() + grid_.discs_below(block, block.end_row));
    }
    mine_ = grid_.block(ranks.rank());
    rank_ = ranks.rank();
  }

  Part make() {
    place_discs();
    join_discs();
    Assembly& assembly = part_.assembly;
    assembly.radii.assign(assembly.size(), lattice_.options().radius);
    assembly.cell_areas.assign(assembly.size(), lattice_.pattern().cell_area);
    assembly.facet_lengths.assign(assembly.contacts.size(), lattice_.pattern().facet_length);
    if (lattice_.options().periodic) {
      assembly.period = lattice_.period();
    } else {
      name_sides();
    }
    return std::move(part_);
  }

 private:
  /// Place of a disc in the order of the blocks.
  [[nodiscard]] std::int64_t place(int row, int column) const {
    const int rank = grid_.rank_of(row, column);
    const BlockGrid::Block block = grid_.block(rank);
    return begin_[static_cast<std::size_t>(rank)] + grid_.discs_below(block, row) + column - block.first_column;
  }

  std::int32_t add(int row, int column) {
    part_.assembly.centres.push_back(lattice_.centre(row, column));
    part_.names.push_back(lattice_.first(row) + column);
    part_.places.push_back(static_cast<PetscInt>(place(row, column)));
    return static_cast<std::int32_t>(part_.assembly.size() - 1);
  }

  void place_discs() {
    part_.assembly.kind = lattice_.pattern().kind;
    for (int row = mine_.first_row; row < mine_.end_row; ++row) {
      for (int k = 0; k < mine_.width(lattice_, row); ++k) add(row, mine_.first_column + k);
    }
    part_.owned = std::ssize(part_.assembly.centres);
  }

  std::int32_t local(int row, int column) {
    const std::int64_t at = place(row, column), mine = begin_[static_cast<std::size_t>(rank_)];
    if (at >= mine && at < mine + part_.owned) return static_cast<std::int32_t>(at - mine);
    const auto [found, is_new] = ghosts_.try_emplace(at, 0);
    if (is_new) found->second = add(row, column);
    return found->second;
  }

  void join_discs() {
    const double radius = lattice_.options().radius;
    std::int32_t disc = 0;
    for (int row = mine_.first_row; row < mine_.end_row; ++row) {
      for (int k = 0; k < mine_.width(lattice_, row); ++k, ++disc) {
        const RowLattice::Neighbours near = lattice_.neighbours(row, mine_.first_column + k);
        for (int n = 0; n < near.count; ++n) {
          const RowLattice::Neighbour& other = near.of[static_cast<std::size_t>(n)];
          part_.assembly.contacts.push_back({.i = disc,
                                             .j = local(other.row, other.column),
                                             .shift_x = other.shift_x,
                                             .shift_y = other.shift_y,
                                             .lever_i = radius,
                                             .lever_j = radius});
        }
      }
    }
  }

  void name_sides() {
    const int rows = lattice_.options().rows;
    auto& groups = part_.assembly.groups;
    for (const char* name :
         {"left", "right", "bottom", "top", "bottom_left", "bottom_right", "top_left", "top_right"}) {
      groups[name] = {};
    }
    const auto put = [&](const char* name, std::int32_t disc, double length) {
      groups[name].discs.push_back(disc);
      if (length > 0) groups[name].tributary_lengths.push_back(length);
    };
    const double height = lattice_.pattern().row_distance, width = 2 * lattice_.options().radius;
    std::int32_t disc = 0;
    for (int row = mine_.first_row; row < mine_.end_row; ++row) {
      for (int k = 0; k < mine_.width(lattice_, row); ++k, ++disc) {
        const int column = mine_.first_column + k;
        const bool left = column == 0, right = column == lattice_.count(row) - 1, bottom = row == 0,
                   top = row == rows - 1;
        if (left) put("left", disc, height);
        if (right) put("right", disc, height);
        if (bottom) put("bottom", disc, width);
        if (top) put("top", disc, width);
        if (bottom && left) put("bottom_left", disc, 0);
        if (bottom && right) put("bottom_right", disc, 0);
        if (top && left) put("top_left", disc, 0);
        if (top && right) put("top_right", disc, 0);
      }
    }
  }

  const RowLattice& lattice_;
  BlockGrid grid_;
  BlockGrid::Block mine_{};
  int rank_ = 0;
  std::vector<std::int64_t> begin_;
  std::unordered_map<std::int64_t, std::int32_t> ghosts_;
  Part part_;
};

}  // namespace

BlockGrid::BlockGrid(const RowLattice& lattice, int ranks) : lattice_(lattice) {
  const LatticeOptions& options = lattice.options();
  const std::int64_t discs = lattice.first(options.rows);
  if (ranks > discs) {
    bad_input(fmt::format("{} ranks are to share {}", ranks, counted(discs, "disc")),
              "each rank needs a disc of its own", "Start fewer ranks (mpirun -n)");
  }
  const double height = lattice.pattern().row_distance / (2 * options.radius);
  double shortest = std::numeric_limits<double>::infinity();
  for (int across = 1; across <= ranks; ++across) {
    const int along = ranks / across;
    if (across * along != ranks || across > options.columns || along > options.rows) continue;
    // The last column of blocks may lack a disc in the short rows.
    const bool short_rows = !options.periodic && lattice.pattern().staggered;
    if (short_rows && across == options.columns && 2 * along > options.rows) continue;
    const double cuts = (across - 1) * options.rows * height + (along - 1) * options.columns;
    if (cuts < shortest) shortest = cuts, across_ = across, along_ = along;
  }
  if (std::isfinite(shortest)) return;
  bad_input(fmt::format("{} ranks cannot share {} columns and {} rows", ranks, options.columns, options.rows),
            "no grid of so many blocks leaves each one a disc", "Start another number of ranks, 2 or 4 for example");
}

BlockGrid::Block BlockGrid::block(int rank) const {
  const int column = rank % across_, row = rank / across_;
  const int columns = lattice_.options().columns, rows = lattice_.options().rows;
  return {cut(rows, along_, row), cut(rows, along_, row + 1), cut(columns, across_, column),
          cut(columns, across_, column + 1)};
}

int BlockGrid::rank_of(int row, int column) const {
  // The largest part with cut <= index.
  const auto part = [&](int index, int count, int parts) {
    int found = static_cast<int>((std::int64_t{index} * parts) / count);
    while (found + 1 < parts && cut(count, parts, found + 1) <= index) ++found;
    return found;
  };
  return part(row, lattice_.options().rows, along_) * across_ + part(column, lattice_.options().columns, across_);
}

std::int64_t BlockGrid::discs_below(const Block& block, int row) const {
  // Two consecutive rows hold as many discs as the next two.
  const std::int64_t rows = row - block.first_row, pairs = rows / 2;
  const int first = block.width(lattice_, block.first_row);
  const int second = block.first_row + 1 < lattice_.options().rows ? block.width(lattice_, block.first_row + 1) : 0;
  return pairs * (first + second) + (rows % 2 != 0 ? first : 0);
}

Part lattice_part(const Ranks& ranks, const RowLattice& lattice) {
  check_row_lattice(lattice.options(), lattice.pattern());
  const double discs = static_cast<double>(lattice.first(lattice.options().rows)) / ranks.count();
  require_memory(bytes_of_network(discs),
                 fmt::format("a part of {} discs needs about", grouped(static_cast<std::int64_t>(discs))));
  return BlockMaker(ranks, lattice).make();
}

namespace {

/// The entries that belong to the chosen discs, in their order.
template <typename Number>
std::vector<Number> of_discs(const std::vector<Number>& all, const std::vector<std::int64_t>& names) {
  std::vector<Number> some;
  some.reserve(names.size());
  for (const std::int64_t name : names) some.push_back(all[static_cast<std::size_t>(name)]);
  return some;
}

}  // namespace

Part delaunay_part(const Ranks& ranks, const DelaunayOptions& options) {
  const auto rank = static_cast<std::int32_t>(ranks.rank());
  const StripShare share{.strip = static_cast<std::size_t>(rank),
                         .count = static_cast<std::size_t>(ranks.count()),
                         .any = [&](bool holds) { return ranks.any(holds); },
                         .joined =
                             [&](const std::vector<std::int32_t>& numbers) {
                               const std::vector<std::int64_t> mine(numbers.begin(), numbers.end());
                               const std::vector<std::int64_t> all = ranks.joined(mine);
                               return std::vector<std::int32_t>(all.begin(), all.end());
                             }};
  DelaunayStrip strip = delaunay_strip(options, share);
  Assembly& whole = strip.assembly;
  // Places: strip by strip, in each by number.
  std::vector<std::int64_t> begin(static_cast<std::size_t>(ranks.count()) + 1, 0);
  for (const std::int32_t owner : strip.strips) ++begin[static_cast<std::size_t>(owner) + 1];
  if (std::any_of(begin.begin() + 1, begin.end(), [](std::int64_t count) { return count == 0; })) {
    bad_input(fmt::format("{} ranks are to share {}", ranks.count(), counted(std::ssize(whole.centres), "disc")),
              "the strip of at least one of them would hold none", "Start fewer ranks (mpirun -n)");
  }
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  std::vector<PetscInt> places(whole.size());
  for (std::size_t d = 0; d < whole.size(); ++d)
    places[d] = static_cast<PetscInt>(begin[static_cast<std::size_t>(strip.strips[d])]++);

  Part part;
  std::vector<std::int32_t> local(whole.size(), -1);
  const auto add = [&](std::int32_t disc) {
    std::int32_t& index = local[static_cast<std::size_t>(disc)];
    if (index < 0) {
      index = static_cast<std::int32_t>(part.names.size());
      part.names.push_back(disc);
    }
    return index;
  };
  for (std::size_t d = 0; d < whole.size(); ++d) {
    if (strip.strips[d] == rank) add(static_cast<std::int32_t>(d));
  }
  part.owned = std::ssize(part.names);
  for (Contact& contact : whole.contacts) {
    contact.i = add(contact.i);
    contact.j = add(contact.j);
  }
  Assembly& assembly = part.assembly;
  assembly.kind = whole.kind;
  assembly.period = whole.period;
  assembly.contacts = std::move(whole.contacts);
  assembly.facet_lengths = std::move(whole.facet_lengths);
  assembly.centres = of_discs(whole.centres, part.names);
  assembly.radii = of_discs(whole.radii, part.names);
  assembly.cell_areas = of_discs(whole.cell_areas, part.names);
  part.places = of_discs(places, part.names);
  for (const auto& [name, group] : whole.groups) {
    DiscGroup& own = assembly.groups[name];
    for (std::size_t k = 0; k < group.discs.size(); ++k) {
      const std::int32_t index = local[static_cast<std::size_t>(group.discs[k])];
      if (index < 0 || index >= part.owned) continue;
      own.discs.push_back(index);
      if (!group.tributary_lengths.empty()) own.tributary_lengths.push_back(group.tributary_lengths[k]);
    }
  }
  return part;
}

}  // namespace equidem::petsc
