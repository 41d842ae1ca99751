// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/ordering/tree_schedule.hpp"

#include <algorithm>
#include <queue>
#include <utility>

#include "equidem/core/threads.hpp"

namespace equidem {

namespace {

class Scheduler {
 public:
  Scheduler(const DissectionTree& tree, std::span<const double> work)
      : nodes_(tree.nodes), below_(work.begin(), work.end()), children_(tree.nodes.size()) {
    for (std::size_t t = 0; t < nodes_.size(); ++t) {
      const std::int32_t parent = nodes_[t].parent;
      if (parent < 0) {
        total_ += below_[t];
      } else {
        below_[parent] += below_[t];
        children_[parent].push_back(static_cast<std::int32_t>(t));
      }
    }
  }

  TreeSchedule run() {
    TreeSchedule schedule;
    const double most = 0.2 * total_;
    const auto small = [&](std::int32_t t) { return below_[t] <= most || children_[t].empty(); };
    std::vector<std::int32_t> roots;  // of the wave that is being filled
    double filled = 0;
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(nodes_.size()); ++t) {
      const std::int32_t parent = nodes_[t].parent;
      if (!small(t)) {
        if (!roots.empty()) schedule.waves.push_back(wave(roots));
        roots.clear();
        filled = 0;
        schedule.waves.back().above.push_back(t);
      } else if (parent < 0 || !small(parent)) {
        if (!roots.empty() && filled + below_[t] > most) {
          schedule.waves.push_back(wave(roots));
          roots.clear();
          filled = 0;
        }
        roots.push_back(t);
        filled += below_[t];
      }
    }
    if (!roots.empty()) schedule.waves.push_back(wave(roots));
    return schedule;
  }

 private:
  /// Open the largest subtree until there are enough for the threads to end at about the same time.
  TreeSchedule::Wave wave(const std::vector<std::int32_t>& roots) const {
    TreeSchedule::Wave result;
    std::priority_queue<std::pair<double, std::int32_t>> largest;
    for (const std::int32_t root : roots) largest.emplace(below_[root], root);
    const std::size_t enough = thread_count() == 1 ? 1 : 8 * static_cast<std::size_t>(thread_count());
    while (largest.size() < enough && !children_[largest.top().second].empty()) {
      const std::int32_t top = largest.top().second;
      largest.pop();
      result.above.push_back(top);
      for (const std::int32_t child : children_[top]) largest.emplace(below_[child], child);
    }
    for (; !largest.empty(); largest.pop()) result.subtrees.push_back(largest.top().second);
    std::sort(result.above.begin(), result.above.end());
    return result;
  }

  const std::vector<DissectionTree::Node>& nodes_;
  std::vector<double> below_;  // work of the subtree
  std::vector<std::vector<std::int32_t>> children_;
  double total_ = 0;
};

}  // namespace

TreeSchedule schedule_tree(const DissectionTree& tree, std::span<const double> work) {
  return Scheduler(tree, work).run();
}

}  // namespace equidem
