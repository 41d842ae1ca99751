// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/ordering/symbolic_factor.hpp"

#include <algorithm>
#include <queue>
#include <utility>

#include "equidem/core/stopwatch.hpp"
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

namespace {

void collect_rows(SymbolicFactor& symbolic, const ContactGraph& graph,
                  const std::vector<std::vector<std::int32_t>>& children, std::size_t t) {
  thread_local std::vector<std::int32_t> found;
  const auto& node = symbolic.tree.nodes[t];
  found.clear();
  for (std::int32_t p = node.begin; p < node.end; ++p) {
    for (const auto& edge : graph.of(symbolic.tree.order[p])) {
      if (symbolic.position[edge.other] >= node.end) found.push_back(symbolic.position[edge.other]);
    }
  }
  for (const std::int32_t child : children[t]) {
    const auto& rows = symbolic.rows[child];
    found.insert(found.end(), std::lower_bound(rows.begin(), rows.end(), node.end), rows.end());
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  symbolic.rows[t].assign(found.begin(), found.end());
}

}  // namespace

double SymbolicFactor::front_operations(std::size_t t) const {
  // Column c of k pivots updates a triangle of r = k + m - c rows: r + r (r + 1) operations.
  const auto k = static_cast<double>(pivots(t)), m = static_cast<double>(updates(t));
  const double n = k + m;
  const auto sum_of_squares = [](double x) { return x * (x + 1) * (2 * x + 1) / 6; };
  return sum_of_squares(n) - sum_of_squares(m);
}

double SymbolicFactor::panel_entries() const {
  double entries = 0;
  for (std::size_t t = 0; t < fronts(); ++t) {
    const auto k = static_cast<double>(pivots(t));
    entries += k * (k + static_cast<double>(updates(t)));
  }
  return entries;
}

SymbolicFactor analyze(DissectionTree tree, const ContactGraph& graph, int block) {
  stop_if_interrupted();
  SymbolicFactor symbolic;
  symbolic.tree = std::move(tree);
  symbolic.block = block;
  symbolic.position.resize(graph.size());
  for (std::size_t p = 0; p < graph.size(); ++p)
    symbolic.position[symbolic.tree.order[p]] = static_cast<std::int32_t>(p);
  const std::size_t fronts = symbolic.fronts();
  symbolic.rows.resize(fronts);
  std::vector<std::vector<std::int32_t>> children(fronts);
  std::vector<double> discs(fronts);
  for (std::size_t t = 0; t < fronts; ++t) {
    const auto& node = symbolic.tree.nodes[t];
    discs[t] = node.end - node.begin;
    if (node.parent >= 0) children[node.parent].push_back(static_cast<std::int32_t>(t));
  }
  for (const TreeSchedule::Wave& wave : schedule_tree(symbolic.tree, discs).waves) {
    parallel_tasks(wave.subtrees.size(), [&](std::size_t s, int) {
      const std::int32_t root = wave.subtrees[s];
      for (std::int32_t t = symbolic.tree.nodes[root].first_descendant; t <= root; ++t) {
        collect_rows(symbolic, graph, children, t);
      }
    });
    for (const std::int32_t t : wave.above) collect_rows(symbolic, graph, children, t);
  }

  for (std::size_t t = 0; t < fronts; ++t) {
    const auto k = static_cast<double>(symbolic.pivots(t)), m = static_cast<double>(symbolic.updates(t));
    symbolic.nonzeros += k * (k + 1) / 2 + k * m;
    symbolic.operations += symbolic.front_operations(t);
    symbolic.largest_front = std::max(symbolic.largest_front, k + m);
  }
  return symbolic;
}

void match_rows(const SymbolicFactor& symbolic, std::size_t child, std::vector<RowRun>& runs) {
  runs.clear();
  const auto& node = symbolic.tree.nodes[symbolic.tree.nodes[child].parent];
  const auto& from = symbolic.rows[child];
  const auto& to = symbolic.rows[symbolic.tree.nodes[child].parent];
  const std::int32_t own = node.end - node.begin;
  std::size_t cursor = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    std::int32_t at = from[k] - node.begin;
    if (at >= own) {
      while (to[cursor] != from[k]) ++cursor;
      at = own + static_cast<std::int32_t>(cursor);
    }
    // A run does not cross from the parent's own discs to its rows: they are stored apart.
    if (!runs.empty() && runs.back().parent + runs.back().count == at && at != own) {
      ++runs.back().count;
    } else {
      runs.push_back({static_cast<std::int32_t>(k), at, 1});
    }
  }
}

}  // namespace equidem
