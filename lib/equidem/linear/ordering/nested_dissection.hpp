// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fill-reducing elimination order of the discs by geometric nested dissection (George 1973), computed on the graph
/// of discs with their positions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/linear/contact_graph.hpp"

namespace equidem {

/// Finds a smallest set of vertices whose removal leaves no path from the source to the sink: by Menger's theorem as
/// many as there are vertex-disjoint paths, found by augmentation in the residual of the graph with split vertices
/// (Even 1979). The object can be used again, so that its memory is, too.
class VertexSeparator {
 public:
  enum class Side : std::uint8_t { low, separator, high };

  /// Start a graph of that many vertices and no edges.
  void clear(std::size_t vertices);
  void add_edge(std::int32_t a, std::int32_t b) { edges_.push_back({a, b}); }
  /// The vertex is next to the source (the low side), or to the sink (the high side); it may be next to both.
  void touch_low(std::int32_t vertex) { touches_low_[vertex] = 1; }
  void touch_high(std::int32_t vertex) { touches_high_[vertex] = 1; }

  /// The side of every vertex. Of all smallest separators the one nearest to the low or the one nearest to the high
  /// side is taken, whichever leaves the sides more alike.
  std::span<const Side> solve();
  /// Vertices in the separator that was found.
  [[nodiscard]] std::size_t size() const { return flow_; }

 private:
  struct Edge {
    std::int32_t a, b;
  };

  void build_lists();
  bool augment_from(std::int32_t start);
  void apply_path(std::size_t last_state);
  void reach_from_low();
  void reach_from_high();
  bool visit(std::size_t state, std::size_t from);

  std::vector<Edge> edges_;
  std::vector<std::uint8_t> touches_low_, touches_high_;
  std::vector<std::int32_t> first_, neighbours_;
  std::vector<std::int32_t> next_, previous_;  // on the path through each vertex
  std::vector<std::int32_t> visited_, cursor_;
  std::vector<std::int64_t> came_from_;
  std::vector<std::size_t> stack_;
  std::vector<Side> sides_, other_sides_;
  std::int32_t round_ = 0;
  std::size_t flow_ = 0;
};

/// A tree of separators. Node t eliminates the discs order[begin, end); its children come before it (postorder), and
/// once they are eliminated the discs of t are coupled to nothing but each other and the discs of its ancestors.
struct DissectionTree {
  struct Node {
    std::int32_t begin = 0;
    std::int32_t end = 0;
    std::int32_t parent = -1;       ///< index into nodes; -1: root
    std::int32_t first_descendant;  ///< nodes [first_descendant, t] are the subtree of t
  };
  std::vector<Node> nodes;          ///< in postorder
  std::vector<std::int32_t> order;  ///< discs in elimination order
};

struct DissectionOptions {
  int leaf_size = 8;  ///< discs that are not divided any further, >= 1
};

/// Divide the discs across the longer side of their bounding box (both sides are tried where they are alike): the
/// separator is a smallest set of discs, within a strip about the median coordinate, without which the two sides do
/// not touch. Contacts through a period are contacts like others, so that a cell is cut open by itself. The result
/// does not depend on the number of threads.
DissectionTree dissect(const Assembly& assembly, const ContactGraph& graph, const DissectionOptions& options = {});

}  // namespace equidem
