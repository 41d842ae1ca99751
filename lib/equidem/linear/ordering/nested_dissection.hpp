// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fill-reducing elimination order of the discs by geometric nested dissection (George 1973), computed on the graph
/// of discs with their positions.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/linear/contact_graph.hpp"

namespace equidem {

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
