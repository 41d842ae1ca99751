// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/delaunay_part.hpp"

#include <algorithm>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem::petsc {
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
