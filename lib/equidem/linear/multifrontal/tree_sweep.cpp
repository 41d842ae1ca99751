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

ForwardSweep::ForwardSweep(const SymbolicFactor& symbolic) : symbolic_(symbolic), handed_(symbolic.fronts(), -1) {
  constexpr double part = 1.0 / 64, of_front = 200;  // share of the work in one subtree; work of a front by itself
  const auto& nodes = symbolic.tree.nodes;
  std::vector<double> below(nodes.size());
  double total = 0;
  for (std::size_t t = 0; t < nodes.size(); ++t) {
    const auto pivots = static_cast<double>(symbolic.pivots(t)), updates = static_cast<double>(symbolic.updates(t));
    const double work = pivots * (pivots + updates) + of_front;
    below[t] += work, total += work;
    if (nodes[t].parent >= 0) below[nodes[t].parent] += below[t];
  }
  std::vector<std::int32_t> height(nodes.size(), 0);
  const auto is_small = [&](std::size_t t) {
    return below[t] <= part * total || nodes[t].first_descendant == static_cast<std::int32_t>(t);
  };
  for (std::size_t t = 0; t < nodes.size(); ++t) {
    const std::int32_t parent = nodes[t].parent;
    const bool small = is_small(t);
    if (small && parent >= 0 && is_small(static_cast<std::size_t>(parent))) continue;
    handed_[t] = all_handed_;
    all_handed_ += static_cast<std::int32_t>(symbolic.rows[t].size());
    if (small) {
      subtrees_.push_back(static_cast<std::int32_t>(t));
    } else {
      const auto level = static_cast<std::size_t>(height[t]);
      if (levels_.size() <= level) levels_.resize(level + 1);
      levels_[level].push_back(static_cast<std::int32_t>(t));
    }
    if (parent >= 0) height[parent] = std::max(height[parent], small ? 0 : height[t] + 1);
  }
}

/// One call of run().
struct ForwardSweep::Sweep {
  const ForwardSweep& all;
  const std::function<Panel(std::size_t)>& panel;
  double* y;
  std::size_t size, columns;
  LargeVector<double> handed;  // front by front, of each its columns one after another

  /// Consecutive rows of a front and where they are kept.
  struct Run {
    double* first;
    std::size_t count, apart;  // numbers; from one column to the next
  };
  struct Work {
    std::vector<double> columns;
    std::vector<Run> runs;
    std::vector<RowRun> matched;
  };
  static Work& work() {
    thread_local Work here;
    return here;
  }

  [[nodiscard]] std::size_t block() const { return static_cast<std::size_t>(all.symbolic_.block); }
  [[nodiscard]] double* handed_by(std::size_t t) {
    return handed.data() + static_cast<std::size_t>(all.handed_[t]) * block() * columns;
  }

  /// The rows of front t in the subtree of `root`: inside it they lie in y, above it in what it hands on.
  void find_runs(std::size_t t, std::size_t root, std::vector<Run>& runs) {
    const auto& rows = all.symbolic_.rows[t];
    const auto& above = all.symbolic_.rows[root];
    const std::int32_t end = all.symbolic_.tree.nodes[root].end;
    const std::size_t b = block();
    double* const to = handed_by(root);
    runs.clear();
    const auto add = [&](double* place, std::size_t apart, bool goes_on) {
      if (goes_on && runs.back().first + runs.back().count == place) {
        runs.back().count += b;
      } else {
        runs.push_back({place, b, apart});
      }
    };
    std::size_t k = 0;
    for (; k < rows.size() && rows[k] < end; ++k) add(y + rows[k] * b, size, k > 0);
    const std::size_t inside = k;
    for (std::size_t cursor = 0; k < rows.size(); ++k) {
      while (above[cursor] != rows[k]) ++cursor;
      add(to + cursor * b, above.size() * b, k > inside);
    }
  }

  void visit_subtree(std::size_t root) {
    Work& here = work();
    const std::size_t b = block();
    std::fill_n(handed_by(root), all.symbolic_.updates(root) * columns, 0.0);
    for (auto t = static_cast<std::size_t>(all.symbolic_.tree.nodes[root].first_descendant); t <= root; ++t) {
      const Panel front = panel(t);
      if (here.columns.size() < front.rows * columns) here.columns.resize(front.rows * columns);
      find_runs(t, root, here.runs);
      double* const own = y + all.symbolic_.tree.nodes[t].begin * b;
      for (std::size_t c = 0; c < columns; ++c) {
        double* to = std::copy_n(own + c * size, front.pivots, here.columns.data() + c * front.rows);
        for (const Run& run : here.runs) to = std::copy_n(run.first + c * run.apart, run.count, to);
      }
      solve_forward(front, here.columns.data(), columns);
      for (std::size_t c = 0; c < columns; ++c) {
        const double* from = here.columns.data() + c * front.rows;
        std::copy_n(from, front.pivots, own + c * size);
        from += front.pivots;
        for (const Run& run : here.runs) {
          std::copy_n(from, run.count, run.first + c * run.apart);
          from += run.count;
        }
      }
    }
  }

  void visit_above(std::size_t t) {
    Work& here = work();
    const std::size_t b = block();
    const auto& nodes = all.symbolic_.tree.nodes;
    const Panel front = panel(t);
    if (here.columns.size() < front.rows * columns) here.columns.resize(front.rows * columns);
    double* const w = here.columns.data();
    double* const own = y + nodes[t].begin * b;
    for (std::size_t c = 0; c < columns; ++c) {
      std::copy_n(own + c * size, front.pivots, w + c * front.rows);
      std::fill_n(w + c * front.rows + front.pivots, front.rows - front.pivots, 0.0);
    }
    // Children in descending order: each begins where the subtree of the one before it has ended.
    for (auto child = static_cast<std::int32_t>(t) - 1; child >= nodes[t].first_descendant;
         child = nodes[child].first_descendant - 1) {
      match_rows(all.symbolic_, static_cast<std::size_t>(child), here.matched);
      const std::size_t rows = all.symbolic_.updates(static_cast<std::size_t>(child));
      const double* const update = handed_by(static_cast<std::size_t>(child));
      for (std::size_t c = 0; c < columns; ++c) {
        for (const RowRun& run : here.matched) {
          const double* from = update + c * rows + run.child * b;
          double* to = w + c * front.rows + run.parent * b;
          for (std::size_t r = 0; r < run.count * b; ++r) to[r] += from[r];
        }
      }
    }
    solve_forward(front, w, columns);
    double* const update = handed_by(t);
    for (std::size_t c = 0; c < columns; ++c) {
      std::copy_n(w + c * front.rows, front.pivots, own + c * size);
      std::copy_n(w + c * front.rows + front.pivots, front.rows - front.pivots,
                  update + c * (front.rows - front.pivots));
    }
  }
};

void ForwardSweep::run(const std::function<Panel(std::size_t)>& panel, double* y, std::size_t size,
                       std::size_t columns) const {
  const std::size_t numbers = static_cast<std::size_t>(all_handed_ * symbolic_.block) * columns;
  Sweep sweep{*this, panel, y, size, columns, LargeVector<double>(numbers)};
  parallel_tasks(subtrees_.size(),
                 [&](std::size_t k, int) { sweep.visit_subtree(static_cast<std::size_t>(subtrees_[k])); });
  for (const auto& level : levels_)
    parallel_tasks(level.size(), [&](std::size_t k, int) { sweep.visit_above(static_cast<std::size_t>(level[k])); });
}

}  // namespace equidem
