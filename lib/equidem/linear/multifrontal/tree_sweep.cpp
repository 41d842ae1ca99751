// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/tree_sweep.hpp"

#include <algorithm>
#include <memory>
#include <mutex>
#include <numeric>

#include "equidem/core/threads.hpp"
#include "equidem/linear/large_buffer.hpp"

namespace equidem {
namespace tree_sweep {

/// Values of nodes in postorder: those of the children of the next node are always on top.
class ValueStack {
 public:
  explicit ValueStack(std::size_t capacity) : memory_(capacity) {}
  double* push(std::size_t size) {
    starts_.push_back(top_);
    top_ += size;
    return memory_.data() + starts_.back();
  }
  /// Remove the `count` entries below the top one, which moves down into their place.
  void drop_below_top(std::size_t count) {
    if (count == 0) return;
    const std::size_t from = starts_.back(), size = top_ - from;
    starts_.resize(starts_.size() - count);
    const std::size_t to = starts_.back();
    std::copy_n(memory_.data() + from, size, memory_.data() + to);  // downwards: overlap does no harm
    top_ = to + size;
  }
  /// double `depth` below the top one.
  const double* below_top(std::size_t depth) const { return memory_.data() + starts_[starts_.size() - 1 - depth]; }
  void clear() { top_ = 0, starts_.clear(); }

 private:
  LargeVector<double> memory_;
  std::vector<std::size_t> starts_;
  std::size_t top_ = 0;
};

}  // namespace tree_sweep

TreeSweep::TreeSweep(const SymbolicFactor& symbolic, const std::function<double(std::size_t)>& work)
    : symbolic_(symbolic), work_(symbolic.fronts()), children_(symbolic.fronts()) {
  for (std::size_t t = 0; t < work_.size(); ++t) {
    work_[t] = work(t);
    const std::int32_t parent = symbolic.tree.nodes[t].parent;
    if (parent >= 0) children_[parent].push_back(static_cast<std::int32_t>(t));
  }
  schedule_ = schedule_tree(symbolic.tree, work_);
}

void TreeSweep::up(const Size& size, const Visit& visit, const std::function<void(double)>& report) const {
  const auto& nodes = symbolic_.tree.nodes;
  const double total = std::accumulate(work_.begin(), work_.end(), 0.0);
  // Updates passed on by the subtree roots and the nodes above them.
  std::vector<LargeVector<double>> handed(nodes.size());
  BufferPool pool;
  // Largest height of the stack over all subtrees.
  std::size_t capacity = 0;
  std::vector<std::size_t> sizes(nodes.size());
  for (std::size_t t = 0; t < nodes.size(); ++t) sizes[t] = size(t);
  for (const TreeSchedule::Wave& wave : schedule_.waves) {
    for (const std::int32_t root : wave.subtrees) {
      std::size_t height = 0;
      for (std::int32_t t = nodes[root].first_descendant; t < root; ++t) {
        height += sizes[t];
        capacity = std::max(capacity, height);
        for (const std::int32_t child : children_[t]) height -= sizes[child];
      }
    }
  }
  std::vector<std::unique_ptr<tree_sweep::ValueStack>> stacks(thread_count());
  std::mutex report_mutex;
  double unreported = 0;

  const auto visit_subtree = [&](std::int32_t root, int worker) {
    if (!stacks[worker]) stacks[worker] = std::make_unique<tree_sweep::ValueStack>(capacity);
    tree_sweep::ValueStack& stack = *stacks[worker];
    stack.clear();
    std::vector<Child> children;
    double done = 0;
    for (std::int32_t t = nodes[root].first_descendant; t <= root; ++t) {
      const std::size_t count = children_[t].size();
      const bool is_root = t == root;
      if (is_root) handed[root] = pool.take(sizes[root]);
      double* values = is_root ? handed[root].data() : stack.push(sizes[t]);
      children.clear();
      for (std::size_t c = 0; c < count; ++c) {
        children.push_back({static_cast<std::size_t>(children_[t][c]), stack.below_top(count - c - (is_root ? 1 : 0))});
      }
      visit(t, values, children);
      if (!is_root) stack.drop_below_top(count);
      done += work_[t];
    }
    const std::lock_guard lock(report_mutex);
    unreported += done;
    if (worker == 0) {
      report(unreported / total);
      unreported = 0;
    }
  };
  const auto visit_above = [&](std::int32_t t) {
    handed[t] = pool.take(sizes[t]);
    std::vector<Child> children;
    for (const std::int32_t child : children_[t]) {
      children.push_back({static_cast<std::size_t>(child), handed[child].data()});
    }
    visit(t, handed[t].data(), children);
    for (const std::int32_t child : children_[t]) pool.give_back(std::move(handed[child]));
    report((unreported + work_[t]) / total);
    unreported = 0;
  };
  for (const TreeSchedule::Wave& wave : schedule_.waves) {
    parallel_tasks(wave.subtrees.size(), [&](std::size_t s, int worker) { visit_subtree(wave.subtrees[s], worker); });
    const bool last = &wave == &schedule_.waves.back();
    if (last) stacks.clear();
    for (const std::int32_t t : wave.above) {
      if (last) pool.clear();  // nothing is left to reuse it, and memory is at its highest
      visit_above(t);
    }
  }
}

void TreeSweep::down(const std::function<void(std::size_t)>& visit) const {
  for (auto wave = schedule_.waves.rbegin(); wave != schedule_.waves.rend(); ++wave) {
    std::for_each(wave->above.rbegin(), wave->above.rend(), visit);
    parallel_tasks(wave->subtrees.size(), [&](std::size_t s, int) {
      const std::int32_t root = wave->subtrees[s];
      for (std::int32_t t = root; t >= symbolic_.tree.nodes[root].first_descendant; --t) visit(t);
    });
  }
}

}  // namespace equidem
