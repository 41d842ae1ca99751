// SPDX-License-Identifier: GPL-3.0-or-later
#include "fill.hpp"

#include <vector>

namespace equidem::bench {

double count_factor_entries(const ContactGraph& graph, const DegreesOfFreedom& unknowns,
                            std::span<const std::int32_t> order) {
  const std::size_t discs = order.size(), block = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<std::int32_t> position(discs), parent(discs, -1), visited(discs, -1);
  std::vector<int> free(discs, 0);  // components not held, by position
  for (std::size_t p = 0; p < discs; ++p) {
    const auto disc = static_cast<std::size_t>(order[p]);
    position[disc] = static_cast<std::int32_t>(p);
    for (std::size_t k = 0; k < block; ++k) free[p] += unknowns.held[disc * block + k] == 0 ? 1 : 0;
  }
  double entries = 0;
  for (std::size_t p = 0; p < discs; ++p) {
    if (free[p] == 0) continue;
    const auto row = static_cast<std::int32_t>(p);
    visited[p] = row;
    entries += 0.5 * free[p] * (free[p] + 1);
    for (const auto& edge : graph.of(static_cast<std::size_t>(order[p]))) {
      std::int32_t column = position[edge.other];
      if (column > row || free[column] == 0) continue;
      while (visited[column] != row) {
        visited[column] = row;
        entries += static_cast<double>(free[p]) * free[column];
        if (parent[column] < 0) parent[column] = row;
        column = parent[column];
      }
    }
  }
  return entries;
}

}  // namespace equidem::bench
