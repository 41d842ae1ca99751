// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Work on the nodes of a dissection tree by several threads: whole subtrees each by one thread, then the nodes above
/// them one after another, each by all threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

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

}  // namespace equidem
