// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/ordering/symbolic_factor.hpp"

#include <algorithm>
#include <utility>

#include "equidem/core/threads.hpp"
#include "equidem/linear/ordering/tree_schedule.hpp"

namespace equidem {
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
