// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Work on the nodes of a dissection tree by several threads: whole subtrees each by one thread, then the
/// nodes above them one after another, each by all threads.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "equidem/statics/nested_dissection.hpp"

namespace equidem {

/// A division of the tree into independent subtrees and the nodes above them. What each node computes does
/// not depend on it.
struct TreeSchedule {
  std::vector<std::int32_t> subtrees;  ///< their roots, the most work first
  std::vector<std::int32_t> above;     ///< the other nodes, children before parents
};

/// \param work of each node, in any unit
TreeSchedule schedule_tree(const DissectionTree& tree, std::span<const double> work);

}  // namespace equidem
