// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "equidem/assembly/space_filling_curve.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"

#include "petsc/part.hpp"

namespace equidem::petsc {
namespace {

[[noreturn]] void too_many_ranks(int ranks, std::int64_t discs) {
  bad_input(fmt::format("{} ranks are to share {}", ranks, counted(discs, "disc")), "each rank needs a disc of its own",
            "Start fewer ranks (mpirun -n)");
}

using Groups = std::map<std::string, DiscGroup>;

/// The discs of each group that a part owns, by their index there.
/// \param groups of the whole, by the names of discs
Groups own_groups(const Groups& groups, const Part& part) {
  std::vector<std::int32_t> order(static_cast<std::size_t>(part.owned));
  std::iota(order.begin(), order.end(), 0);
  const auto name_of = [&](std::int32_t index) { return part.names[static_cast<std::size_t>(index)]; };
  std::ranges::sort(order, {}, name_of);
  Groups own;
  for (const auto& [name, group] : groups) {
    DiscGroup& mine = own[name];
    for (std::size_t k = 0; k < group.discs.size(); ++k) {
      const auto found = std::ranges::lower_bound(order, std::int64_t{group.discs[k]}, {}, name_of);
      if (found == order.end() || name_of(*found) != group.discs[k]) continue;
      mine.discs.push_back(*found);
      if (!group.tributary_lengths.empty()) mine.tributary_lengths.push_back(group.tributary_lengths[k]);
    }
  }
  return own;
}

/// A grid of ranks over the columns and rows of a lattice; blocks are numbered row by row.
class BlockGrid {
 public:
  /// The grid with the shortest cuts.
  /// \throws Error (bad_input) where some rank would have no disc
  BlockGrid(const RowLattice& lattice, int ranks);

  struct Block {
    int first_row, end_row, first_column, end_column;
    /// Columns of the block in a row of the lattice.
    [[nodiscard]] int width(const RowLattice& lattice, int row) const {
      return std::max(0, std::min(end_column, lattice.count(row)) - first_column);
    }
  };
  [[nodiscard]] Block block(int rank) const;
  [[nodiscard]] int rank_of(int row, int column) const;
  /// Discs of a block in the rows from its first one up to `row`.
  [[nodiscard]] std::int64_t discs_below(const Block& block, int row) const;

 private:
  [[nodiscard]] int cut(int count, int parts, int part) const {
    return static_cast<int>(std::int64_t{count} * part / parts);
  }

  const RowLattice& lattice_;
  int across_ = 1;  ///< blocks side by side
  int along_ = 1;   ///< blocks one above the other
};

BlockGrid::BlockGrid(const RowLattice& lattice, int ranks) : lattice_(lattice) {
  const LatticeOptions& options = lattice.options();
  const std::int64_t discs = lattice.first(options.rows);
  if (ranks > discs) too_many_ranks(ranks, discs);
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

}  // namespace

Part lattice_part(const Ranks& ranks, const RowLattice& lattice) {
  check_row_lattice(lattice.options(), lattice.pattern());
  const double discs = static_cast<double>(lattice.first(lattice.options().rows)) / ranks.count();
  require_memory(bytes_of_network(discs),
                 fmt::format("a part of {} discs needs about", grouped(static_cast<std::int64_t>(discs))));
  const BlockGrid grid(lattice, ranks.count());
  std::vector<std::int64_t> begin{0};
  for (int rank = 0; rank < ranks.count(); ++rank) {
    const BlockGrid::Block block = grid.block(rank);
    begin.push_back(begin.back() + grid.discs_below(block, block.end_row));
  }
  Part part;
  Assembly& assembly = part.assembly;
  assembly.kind = lattice.pattern().kind;
  std::unordered_map<std::int64_t, std::int32_t> index;  // of discs, by place
  const auto add = [&](int row, int column) {
    const int rank = grid.rank_of(row, column);
    const BlockGrid::Block block = grid.block(rank);
    const std::int64_t place =
        begin[static_cast<std::size_t>(rank)] + grid.discs_below(block, row) + column - block.first_column;
    const std::int64_t mine = place - begin[static_cast<std::size_t>(ranks.rank())];
    if (mine >= 0 && mine < part.owned) return static_cast<std::int32_t>(mine);
    const auto next = static_cast<std::int32_t>(assembly.size());
    const auto [found, is_new] = part.owned > 0 ? index.try_emplace(place, next) : std::pair{index.end(), true};
    if (!is_new) return found->second;
    assembly.centres.push_back(lattice.centre(row, column));
    part.names.push_back(lattice.first(row) + column);
    part.places.push_back(static_cast<PetscInt>(place));
    return next;
  };
  const BlockGrid::Block block = grid.block(ranks.rank());
  const auto for_own = [&](const auto& visit) {
    for (int row = block.first_row; row < block.end_row; ++row)
      for (int k = 0; k < block.width(lattice, row); ++k) visit(row, block.first_column + k);
  };
  for_own(add);
  part.owned = std::ssize(assembly.centres);
  const double radius = lattice.options().radius;
  std::int32_t disc = 0;
  for_own([&](int row, int column) {
    const RowLattice::Neighbours near = lattice.neighbours(row, column);
    for (int n = 0; n < near.count; ++n) {
      const RowLattice::Neighbour& other = near.of[static_cast<std::size_t>(n)];
      const std::int32_t j = add(other.row, other.column);
      assembly.contacts.push_back({disc, j, other.shift_x, other.shift_y, radius, radius});
    }
    ++disc;
  });
  assembly.radii.assign(assembly.size(), radius);
  assembly.cell_areas.assign(assembly.size(), lattice.pattern().cell_area);
  assembly.facet_lengths.assign(assembly.contacts.size(), lattice.pattern().facet_length);
  if (lattice.options().periodic) {
    assembly.period = lattice.period();
  } else {
    assembly.groups = own_groups(row_lattice_sides(lattice), part);
  }
  return part;
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
  if (std::any_of(begin.begin() + 1, begin.end(), [](std::int64_t count) { return count == 0; }))
    too_many_ranks(ranks.count(), std::ssize(whole.centres));
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
  assembly.groups = own_groups(whole.groups, part);
  return part;
}

namespace {

/// Numbers of discs or of contacts for each rank, on rank 0.
using Lists = std::vector<std::vector<std::int32_t>>;

/// Each rank receives the values on its list, of the values that rank 0 has; none where it has none.
template <typename Value>
requires std::is_trivially_copyable_v<Value> std::vector<Value> handed_out(const Ranks& ranks,
                                                                           const std::vector<Value>& all,
                                                                           const Lists& lists) {
  std::vector<Value> given;
  std::vector<int> counts(lists.size(), 0), first(lists.size(), 0);
  for (std::size_t rank = 0; rank < lists.size() && !all.empty(); ++rank) {
    first[rank] = static_cast<int>(given.size());
    counts[rank] = static_cast<int>(lists[rank].size());
    for (const std::int32_t k : lists[rank]) given.push_back(all[static_cast<std::size_t>(k)]);
  }
  int count = 0;
  MPI_Scatter(counts.data(), 1, MPI_INT, &count, 1, MPI_INT, 0, ranks.communicator());
  std::vector<Value> own(static_cast<std::size_t>(count));
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(sizeof(Value), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Scatterv(given.data(), counts.data(), first.data(), type, own.data(), count, type, 0, ranks.communicator());
  MPI_Type_free(&type);
  return own;
}

/// The text that rank 0 has.
std::string handed_on(const Ranks& ranks, const std::string& text) {
  const std::vector<std::int64_t> letters(text.begin(), text.end()), all = ranks.joined(letters);
  return {all.begin(), all.end()};
}

/// Stretches of Hilbert's curve, with the ghosts of their contacts.
struct Division {
  Lists discs, contacts;
  std::vector<std::int64_t> owned;  ///< discs of each rank
  std::vector<PetscInt> places;     ///< per disc of the whole

  explicit Division(int ranks) : discs(static_cast<std::size_t>(ranks)), contacts(discs.size()), owned(discs.size()) {}

  void divide(const Assembly& whole) {
    const std::vector<std::int32_t> order = hilbert_order(whole.centres);
    std::vector<std::size_t> owner(whole.size());
    places.resize(whole.size());
    for (std::size_t rank = 0, k = 0; rank < discs.size(); ++rank) {
      for (const std::size_t end = whole.size() * (rank + 1) / discs.size(); k < end; ++k) {
        const auto disc = static_cast<std::size_t>(order[k]);
        places[disc] = static_cast<PetscInt>(k);
        owner[disc] = rank;
        discs[rank].push_back(order[k]);
      }
      owned[rank] = std::ssize(discs[rank]);
    }
    for (std::size_t c = 0; c < whole.contacts.size(); ++c)
      contacts[owner[static_cast<std::size_t>(whole.contacts[c].i)]].push_back(static_cast<std::int32_t>(c));
    std::vector<std::size_t> seen(whole.size(), discs.size());  // the last rank that has the disc as a ghost
    for (std::size_t rank = 0; rank < discs.size(); ++rank) {
      for (const std::int32_t c : contacts[rank]) {
        const std::int32_t j = whole.contacts[static_cast<std::size_t>(c)].j;
        const auto disc = static_cast<std::size_t>(j);
        if (owner[disc] == rank || std::exchange(seen[disc], rank) == rank) continue;
        discs[rank].push_back(j);
      }
    }
  }
};

}  // namespace

ScatteredPart scattered_part(const Ranks& ranks, const Assembly* given, const ContactSprings* springs) {
  Division division(ranks.count());
  ranks.together([&] {
    if (!ranks.first()) return;
    if (static_cast<std::size_t>(ranks.count()) > given->size())
      too_many_ranks(ranks.count(), std::ssize(given->centres));
    division.divide(*given);
  });
  const Assembly nothing;
  const Assembly& whole = ranks.first() ? *given : nothing;
  ScatteredPart result;
  Part& part = result.part;
  Assembly& assembly = part.assembly;
  const auto of_discs = [&](const auto& all) { return handed_out(ranks, all, division.discs); };
  const auto of_contacts = [&](const auto& all) { return handed_out(ranks, all, division.contacts); };
  std::vector<std::int64_t> names(whole.size());
  std::iota(names.begin(), names.end(), std::int64_t{0});
  part.names = of_discs(names);
  part.places = of_discs(division.places);
  MPI_Scatter(division.owned.data(), 1, MPI_INT64_T, &part.owned, 1, MPI_INT64_T, 0, ranks.communicator());
  assembly.kind = handed_on(ranks, whole.kind);
  assembly.centres = of_discs(whole.centres);
  assembly.radii = of_discs(whole.radii);
  assembly.cell_areas = of_discs(whole.cell_areas);
  assembly.sections = of_discs(whole.sections);
  assembly.contacts = of_contacts(whole.contacts);
  assembly.facet_lengths = of_contacts(whole.facet_lengths);
  assembly.contact_arms = of_contacts(whole.contact_arms);
  assembly.contact_normal_force = of_contacts(whole.contact_normal_force);
  assembly.contact_tangential_force = of_contacts(whole.contact_tangential_force);
  std::unordered_map<std::int64_t, std::int32_t> local;
  for (std::size_t d = 0; d < assembly.size(); ++d) local[part.names[d]] = static_cast<std::int32_t>(d);
  for (Contact& contact : assembly.contacts) contact.i = local.at(contact.i), contact.j = local.at(contact.j);
  double period[2] = {0, 0};
  if (whole.period) period[0] = whole.period->x, period[1] = whole.period->y;
  ranks.sum(period);
  if (period[0] > 0) assembly.period = Vec2{period[0], period[1]};
  // Groups whole, since they are small beside the assembly; each rank keeps its own discs.
  Groups groups;
  const auto count = static_cast<std::size_t>(ranks.sum(std::ssize(whole.groups)));
  for (auto [k, next] = std::pair{std::size_t{0}, whole.groups.begin()}; k < count; ++k) {
    const auto& [name, group] = ranks.first() ? *next++ : std::pair<const std::string, DiscGroup>{};
    DiscGroup& here = groups[handed_on(ranks, name)];
    const std::vector<std::int64_t> discs(group.discs.begin(), group.discs.end()), all = ranks.joined(discs);
    here.discs.assign(all.begin(), all.end());
    here.tributary_lengths = group.tributary_lengths;
    here.tributary_lengths.resize(static_cast<std::size_t>(ranks.sum(std::ssize(group.tributary_lengths))));
    ranks.sum(here.tributary_lengths);
  }
  assembly.groups = own_groups(groups, part);
  std::vector<SpringConstants> of_whole;
  std::vector<double> bending;
  std::vector<ContactPrestress> prestress;
  for (std::size_t c = 0; c < whole.contacts.size(); ++c) {
    of_whole.push_back((*springs)[c]);
    if (springs->prestressed()) prestress.push_back(*springs->prestress(c));
    if (springs->bends()) bending.push_back(springs->bending(c));
  }
  result.springs =
      ContactSprings(of_contacts(of_whole)).with_bending(of_contacts(bending)).with_prestress(of_contacts(prestress));
  return result;
}

}  // namespace equidem::petsc
