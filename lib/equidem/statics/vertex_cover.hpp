// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Minimum vertex cover of a bipartite graph.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace equidem {

/// Collects edges between low and high vertices and finds a smallest set of vertices that touches every edge:
/// by Koenig's theorem from a maximum matching (augmenting paths, after a greedy start). Reusable, so that
/// its memory is too.
class VertexCover {
 public:
  void clear() { edges_.clear(); }
  /// `low` and `high` are any numbers; no number may appear on both sides.
  void add_edge(std::int32_t low, std::int32_t high) { edges_.emplace_back(low, high); }
  /// The cover, in ascending order within its low and its high part.
  std::vector<std::int32_t> smallest();

 private:
  void index_vertices();
  void match_greedily();
  bool augment_from(std::int32_t low);

  std::vector<std::pair<std::int32_t, std::int32_t>> edges_;
  std::vector<std::int32_t> lows_, highs_;        // vertex numbers, ascending
  std::vector<std::int32_t> first_, neighbours_;  // highs (indices) of each low
  std::vector<std::int32_t> match_of_low_, match_of_high_;
  std::vector<std::int32_t> visited_, cursor_, path_;
  std::int32_t round_ = 0;
};

}  // namespace equidem
