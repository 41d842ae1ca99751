// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The structure of the factor: the discs of each front, and the division of work on the fronts by several threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/ordering/nested_dissection.hpp"

namespace equidem {

/// A division of the tree into waves, worked off one after another. What each node computes does not depend on it.
struct TreeSchedule {
  struct Wave {
    std::vector<std::int32_t> subtrees;  ///< their roots, independent of each other, the most work first
    std::vector<std::int32_t> above;  ///< nodes that only wait for subtrees of this and earlier waves, children first
  };
  std::vector<Wave> waves;
};

/// Waves take a fifth of the work each: what waits for its parent is then the update matrices of a few small
/// subtrees and of some finished waves, not of all subtrees at once.
/// \param work of each node, in any unit
TreeSchedule schedule_tree(const DissectionTree& tree, std::span<const double> work);

/// Fronts of a multifrontal factorization (Duff & Reid 1983), one for each node of the dissection tree. Discs are
/// named by their position in the elimination order.
struct SymbolicFactor {
  DissectionTree tree;
  int block = 2;                                ///< unknowns of a disc
  std::vector<std::int32_t> position;           ///< of each disc in the elimination order
  std::vector<std::vector<std::int32_t>> rows;  ///< per node, ascending: the later discs that its own couple to
  double nonzeros = 0;                          ///< of L, lower triangle
  double operations = 0;                        ///< multiplications and additions of the factorization
  double largest_front = 0;                     ///< rows of the largest front

  [[nodiscard]] std::size_t fronts() const { return tree.nodes.size(); }
  /// Unknowns that front t eliminates.
  [[nodiscard]] std::size_t pivots(std::size_t t) const {
    return static_cast<std::size_t>(block) * (tree.nodes[t].end - tree.nodes[t].begin);
  }
  /// Unknowns of later fronts that front t updates.
  [[nodiscard]] std::size_t updates(std::size_t t) const { return block * rows[t].size(); }
  /// Multiplications and additions of front t.
  [[nodiscard]] double front_operations(std::size_t t) const;
  /// Numbers in the factor's panels.
  [[nodiscard]] double panel_entries() const;
};

SymbolicFactor analyze(DissectionTree tree, const ContactGraph& graph, int block);

/// A run of consecutive discs of a child that are consecutive in its parent, too.
struct RowRun {
  std::int32_t child;   ///< first index into the child's rows
  std::int32_t parent;  ///< first index into the parent's front: its own discs, then its rows
  std::int32_t count;
};

/// The places of the rows of a child in its parent's front.
void match_rows(const SymbolicFactor& symbolic, std::size_t child, std::vector<RowRun>& runs);

/// A vector of discs x block components, from the order of discs to the order of elimination and back.
inline void permute_to_elimination(const SymbolicFactor& symbolic, std::span<const double> x, std::span<double> y) {
  const int b = symbolic.block;
  for (std::size_t p = 0; p < symbolic.position.size(); ++p) {
    for (int r = 0; r < b; ++r) y[p * b + r] = x[static_cast<std::size_t>(symbolic.tree.order[p]) * b + r];
  }
}
inline void permute_from_elimination(const SymbolicFactor& symbolic, std::span<const double> y, std::span<double> x) {
  const int b = symbolic.block;
  for (std::size_t p = 0; p < symbolic.position.size(); ++p) {
    for (int r = 0; r < b; ++r) x[static_cast<std::size_t>(symbolic.tree.order[p]) * b + r] = y[p * b + r];
  }
}

}  // namespace equidem
