// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/tree_schedule.hpp"

#include <algorithm>
#include <queue>
#include <utility>

#include "equidem/core/threads.hpp"

namespace equidem {

TreeSchedule schedule_tree(const DissectionTree& tree, std::span<const double> work) {
  const auto& nodes = tree.nodes;
  std::vector<double> below(work.begin(), work.end());
  std::vector<std::vector<std::int32_t>> children(nodes.size());
  TreeSchedule schedule;
  std::priority_queue<std::pair<double, std::int32_t>> largest;
  for (std::size_t t = 0; t < nodes.size(); ++t) {
    if (nodes[t].parent >= 0) {
      below[nodes[t].parent] += below[t];
      children[nodes[t].parent].push_back(static_cast<std::int32_t>(t));
    }
  }
  for (std::size_t t = 0; t < nodes.size(); ++t) {
    if (nodes[t].parent < 0) largest.emplace(below[t], static_cast<std::int32_t>(t));
  }
  // Open the largest subtree until there are enough for the threads to end at about the same time.
  const std::size_t enough = thread_count() == 1 ? 1 : 8 * static_cast<std::size_t>(thread_count());
  while (!largest.empty() && largest.size() < enough && !children[largest.top().second].empty()) {
    const std::int32_t top = largest.top().second;
    largest.pop();
    schedule.above.push_back(top);
    for (const std::int32_t child : children[top]) largest.emplace(below[child], child);
  }
  for (; !largest.empty(); largest.pop()) schedule.subtrees.push_back(largest.top().second);
  std::sort(schedule.above.begin(), schedule.above.end());
  return schedule;
}

}  // namespace equidem
