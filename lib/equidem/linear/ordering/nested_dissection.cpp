// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/ordering/nested_dissection.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

// Values in place of the predecessor or the successor of a vertex: it is on no path; it is the first or the last one.
constexpr std::int32_t off_path = -1, terminal = -2;

// Every vertex is split: a path enters at `in` and leaves at `out`, and the arc between takes one path.
constexpr std::size_t in(std::int32_t v) {
  return 2 * static_cast<std::size_t>(v);
}
constexpr std::size_t out(std::int32_t v) {
  return 2 * static_cast<std::size_t>(v) + 1;
}
constexpr std::int32_t vertex_of(std::size_t state) {
  return static_cast<std::int32_t>(state / 2);
}
constexpr bool is_out(std::size_t state) {
  return state % 2 == 1;
}

}  // namespace

void VertexSeparator::clear(std::size_t vertices) {
  edges_.clear();
  touches_low_.assign(vertices, 0);
  touches_high_.assign(vertices, 0);
}

void VertexSeparator::build_lists() {
  const std::size_t n = touches_low_.size();
  first_.assign(n + 1, 0);
  for (const Edge& e : edges_) ++first_[e.a + 1], ++first_[e.b + 1];
  for (std::size_t v = 0; v < n; ++v) first_[v + 1] += first_[v];
  neighbours_.resize(2 * edges_.size());
  cursor_.assign(first_.begin(), first_.end() - 1);
  for (const Edge& e : edges_) {
    neighbours_[cursor_[e.a]++] = e.b;
    neighbours_[cursor_[e.b]++] = e.a;
  }
}

bool VertexSeparator::visit(std::size_t state, std::size_t from) {
  if (visited_[state] == round_) return false;
  visited_[state] = round_;
  came_from_[state] = static_cast<std::int64_t>(from);
  if (is_out(state)) cursor_[vertex_of(state)] = first_[vertex_of(state)];
  stack_.push_back(state);
  return true;
}

// Depth first through the residual graph:
//   in(v) -> out(v) where v is on no path, else in(v) -> out(u) of the vertex u before it (that path is
//   diverted); out(v) -> in(w) of every neighbour, and out(v) -> in(v) where v is on a path (which then
//   leaves v out).
// Dead ends stay marked for the whole round.
bool VertexSeparator::augment_from(std::int32_t start) {
  stack_.clear();
  if (!visit(in(start), in(start))) return false;
  while (!stack_.empty()) {
    const std::size_t state = stack_.back();
    const std::int32_t v = vertex_of(state);
    const bool on_path = previous_[v] != off_path;
    if (!is_out(state)) {
      const bool moved = !on_path                   ? visit(out(v), state)
                         : previous_[v] == terminal ? false
                                                    : visit(out(previous_[v]), state);
      if (!moved) stack_.pop_back();
      continue;
    }
    if (touches_high_[v] != 0 && next_[v] != terminal) {
      apply_path(state);
      return true;
    }
    bool moved = false;
    while (!moved && cursor_[v] < first_[v + 1]) {
      const std::int32_t w = neighbours_[cursor_[v]++];
      if (w != next_[v]) moved = visit(in(w), state);
    }
    if (!moved && on_path) moved = visit(in(v), state);
    if (!moved) stack_.pop_back();
  }
  return false;
}

/// Divert paths along the states that led to `last_state`, from which the sink was reached.
void VertexSeparator::apply_path(std::size_t last_state) {
  std::vector<std::size_t>& path = stack_;
  path.clear();
  for (std::size_t state = last_state;; state = static_cast<std::size_t>(came_from_[state])) {
    path.push_back(state);
    if (static_cast<std::size_t>(came_from_[state]) == state) break;
  }
  std::reverse(path.begin(), path.end());
  previous_[vertex_of(path.front())] = terminal;
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const std::int32_t v = vertex_of(path[k]), w = vertex_of(path[k + 1]);
    if (!is_out(path[k])) continue;
    if (v == w) {  // the path that went through v no longer does
      next_[v] = previous_[v] = off_path;
    } else {
      next_[v] = w;
      previous_[w] = v;
    }
  }
  next_[vertex_of(last_state)] = terminal;
}

/// States that the source can still reach.
void VertexSeparator::reach_from_low() {
  ++round_;
  for (std::size_t v = 0; v < touches_low_.size(); ++v) {
    if (touches_low_[v] != 0) augment_from(static_cast<std::int32_t>(v));
  }
  for (std::size_t v = 0; v < sides_.size(); ++v) {
    const auto index = static_cast<std::int32_t>(v);
    sides_[v] = visited_[out(index)] == round_  ? Side::low
                : visited_[in(index)] == round_ ? Side::separator
                                                : Side::high;
  }
}

/// States that can still reach the sink, against the arcs of augment_from.
void VertexSeparator::reach_from_high() {
  ++round_;
  stack_.clear();
  const auto mark = [&](std::size_t state) {
    if (visited_[state] == round_) return;
    visited_[state] = round_;
    stack_.push_back(state);
  };
  for (std::size_t v = 0; v < touches_high_.size(); ++v) {
    if (touches_high_[v] != 0) mark(out(static_cast<std::int32_t>(v)));
  }
  while (!stack_.empty()) {
    const std::size_t state = stack_.back();
    stack_.pop_back();
    const std::int32_t v = vertex_of(state);
    const bool on_path = previous_[v] != off_path;
    if (is_out(state)) {
      if (!on_path) mark(in(v));
      if (on_path && next_[v] != terminal) mark(in(next_[v]));
    } else {
      for (std::int32_t e = first_[v]; e < first_[v + 1]; ++e) {
        if (next_[neighbours_[e]] != v) mark(out(neighbours_[e]));
      }
      if (on_path) mark(out(v));
    }
  }
  for (std::size_t v = 0; v < other_sides_.size(); ++v) {
    const auto index = static_cast<std::int32_t>(v);
    other_sides_[v] = visited_[in(index)] == round_    ? Side::high
                      : visited_[out(index)] == round_ ? Side::separator
                                                       : Side::low;
  }
}

std::span<const VertexSeparator::Side> VertexSeparator::solve() {
  const std::size_t n = touches_low_.size();
  build_lists();
  next_.assign(n, off_path);
  previous_.assign(n, off_path);
  visited_.assign(2 * n, 0);
  came_from_.assign(2 * n, 0);
  cursor_.assign(n, 0);
  sides_.resize(n);
  other_sides_.resize(n);
  round_ = 0;
  flow_ = 0;
  for (bool found = true; found;) {
    found = false;
    ++round_;
    for (std::size_t v = 0; v < n; ++v) {
      if (touches_low_[v] == 0 || previous_[v] == terminal) continue;
      if (augment_from(static_cast<std::int32_t>(v))) {
        ++flow_;
        found = true;
      }
    }
  }
  reach_from_low();
  reach_from_high();
  const auto imbalance = [](const std::vector<Side>& sides) {
    const auto lows = std::count(sides.begin(), sides.end(), Side::low);
    const auto highs = std::count(sides.begin(), sides.end(), Side::high);
    return std::max(lows, highs) - std::min(lows, highs);
  };
  return imbalance(other_sides_) < imbalance(sides_) ? other_sides_ : sides_;
}

namespace {

/// A disc as the recursion moves it about: coordinates in single precision serve only to choose sides.
struct Item {
  std::array<float, 2> at;     ///< position
  std::array<float, 2> reach;  ///< largest distance along x, y to a disc it touches
  std::int32_t disc;
};

/// A part of the plane to be divided: items [begin, end), whose discs carry `label`.
struct Part {
  std::int32_t begin = 0, end = 0, label = 0;
  [[nodiscard]] std::int32_t size() const { return end - begin; }
};

/// A part after dissection: it eliminates items [begin, end) after its children, which are named by their labels.
struct Division {
  std::int32_t begin = 0, end = 0;
  std::array<std::int32_t, 2> children{-1, -1};
};

/// A division of a part into two sides and their separator. Discs in the strip about the cut have the side that is
/// listed; the others are low below `place`, else high.
struct Cut {
  int axis = 0;
  float place = 0;
  std::vector<std::int32_t> strip;  ///< discs
  std::vector<VertexSeparator::Side> sides;
  std::size_t separator_size = 0;
};

struct Scratch {
  std::vector<float> coordinates;
  std::vector<Item> items;
  VertexSeparator separator;
};

// Labels of discs whose side a cut has decided.
constexpr std::int32_t decided_low = -1, decided_high = -2, separated = -3;

std::int32_t decided(VertexSeparator::Side side) {
  return side == VertexSeparator::Side::low    ? decided_low
         : side == VertexSeparator::Side::high ? decided_high
                                               : separated;
}

class Dissection {
 public:
  Dissection(const Assembly& assembly, const ContactGraph& graph, const DissectionOptions& options)
      : graph_(graph),
        options_(options),
        items_(graph.size()),
        coordinates_(graph.size()),
        label_(graph.size(), 0),
        strip_index_(graph.size(), -1),
        divisions_(2 * graph.size() + 1),
        scratch_(static_cast<std::size_t>(thread_count())) {
    // Counted from the lower left corner, so that single precision is spent on the assembly and not on where
    // it lies.
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      const Vec2 x = assembly.centres[d];
      corner_ = d == 0 ? x : Vec2{std::min(corner_.x, x.x), std::min(corner_.y, x.y)};
    }
    parallel_ranges(items_.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
      for (std::size_t d = first; d < last; ++d) {
        items_[d] = item(assembly, d);
        coordinates_[d] = items_[d].at;
      }
    });
  }

  DissectionTree run() {
    DissectionTree tree;
    if (items_.empty()) return tree;
    divide_all({0, static_cast<std::int32_t>(items_.size()), 0});
    tree.order.reserve(items_.size());
    for (const Item& it : items_) tree.order.push_back(it.disc);
    std::vector<std::int32_t> roots;
    emit(0, tree, roots);
    return tree;
  }

 private:
  Item item(const Assembly& assembly, std::size_t d) const {
    const Vec2 x = assembly.centres[d] - corner_;
    Vec2 reach;
    for (const auto& edge : graph_.of(d)) {
      const Vec2 y = assembly.centres[edge.other] - corner_;
      reach.x = std::max(reach.x, std::abs(y.x - x.x));
      reach.y = std::max(reach.y, std::abs(y.y - x.y));
    }
    // Rounding to single precision must not let the reach come out short.
    const auto generous = [](double r, double at) { return static_cast<float>(1.000001 * r + 1e-6 * std::abs(at)); };
    return {{static_cast<float>(x.x), static_cast<float>(x.y)},
            {generous(reach.x, x.x), generous(reach.y, x.y)},
            static_cast<std::int32_t>(d)};
  }

  // Threads read labels of discs that belong to other threads' parts; whatever they read, it is not their own
  // label.
  std::int32_t label_of(std::int32_t disc) { return std::atomic_ref(label_[disc]).load(std::memory_order_relaxed); }
  void set_label(std::int32_t disc, std::int32_t label) {
    std::atomic_ref(label_[disc]).store(label, std::memory_order_relaxed);
  }

  /// Large parts level by level, each level in parallel; then the small ones, each by one thread to its leaves.
  void divide_all(Part root) {
    constexpr std::int32_t small = 20000;
    std::vector<Part> level{root}, small_parts;
    while (!level.empty()) {
      std::vector<std::vector<Part>> children(level.size());
      parallel_tasks(level.size(), [&](std::size_t k, int worker) { divide(level[k], children[k], scratch_[worker]); });
      level.clear();
      for (const auto& parts : children) {
        for (const Part& part : parts) (part.size() > small ? level : small_parts).push_back(part);
      }
    }
    parallel_tasks(small_parts.size(), [&](std::size_t k, int worker) {
      std::vector<Part> open{small_parts[k]};
      while (!open.empty()) {
        const Part part = open.back();
        open.pop_back();
        divide(part, open, scratch_[worker]);
      }
    });
  }

  /// Divide a part and append its children. A binary tree over n discs has at most 2n - 1 nodes: a part of n discs
  /// owns the labels [label, label + 2n - 1), so that parts can be divided in any order.
  void divide(const Part& part, std::vector<Part>& open, Scratch& scratch) {
    Division& division = divisions_[part.label];
    division = {part.begin, part.end, {-1, -1}};
    if (part.size() <= std::max(1, options_.leaf_size)) return;
    const Cut cut = best_cut(part, scratch);
    for (std::size_t k = 0; k < cut.strip.size(); ++k) set_label(cut.strip[k], decided(cut.sides[k]));

    std::array<std::int32_t, 3> counts{};  // low side, high side, separator
    for (std::int32_t k = part.begin; k < part.end; ++k) ++counts[side_of(items_[k], cut)];
    if (counts[0] == part.size() || counts[1] == part.size() || counts[2] == part.size()) return;  // discs coincide
    const Part low{part.begin, part.begin + counts[0], part.label + 1};
    const Part high{low.end, low.end + counts[1], low.label + std::max(0, 2 * counts[0] - 1)};

    scratch.items.assign(items_.begin() + part.begin, items_.begin() + part.end);
    std::array<std::int32_t, 3> next{low.begin, high.begin, high.end};
    for (const Item& it : scratch.items) {
      const int side = side_of(it, cut);
      items_[next[side]++] = it;
      if (side < 2) set_label(it.disc, side == 0 ? low.label : high.label);
    }
    const int along = 1 - cut.axis;
    std::sort(items_.begin() + high.end, items_.begin() + part.end, [along](const Item& a, const Item& b) {
      return a.at[along] != b.at[along] ? a.at[along] < b.at[along] : a.disc < b.disc;
    });

    division = {high.end, part.end, {-1, -1}};
    int made = 0;
    for (const Part& child : {low, high}) {
      if (child.size() == 0) continue;
      division.children[made++] = child.label;
      open.push_back(child);
    }
  }

  /// 0: low, 1: high, 2: separator.
  int side_of(const Item& it, const Cut& cut) {
    switch (label_of(it.disc)) {
      case decided_low:
        return 0;
      case decided_high:
        return 1;
      case separated:
        return 2;
      default:
        return it.at[cut.axis] < cut.place ? 0 : 1;
    }
  }

  Cut best_cut(const Part& part, Scratch& scratch) {
    std::array<float, 2> lowest = items_[part.begin].at, highest = lowest;
    for (std::int32_t k = part.begin; k < part.end; ++k) {
      for (const int a : {0, 1}) {
        lowest[a] = std::min(lowest[a], items_[k].at[a]);
        highest[a] = std::max(highest[a], items_[k].at[a]);
      }
    }
    const float width = highest[0] - lowest[0], height = highest[1] - lowest[1];
    const int longer = width >= height ? 0 : 1;
    Cut cut = median_cut(part, longer, scratch);
    // Where the sides are alike, the cut that crosses fewer discs wins.
    constexpr float alike = 0.75F;
    if (std::min(width, height) > alike * std::max(width, height)) {
      Cut other = median_cut(part, 1 - longer, scratch);
      if (other.separator_size < cut.separator_size) cut = std::move(other);
    }
    return cut;
  }

  /// The smallest separator in a strip about the median coordinate, or, in a part of fewer than 64 discs, along the
  /// median itself. Half of the strip holds 5 layers of sqrt(n) of the n discs, and at most a share of 0.12 of them.
  Cut median_cut(const Part& part, int axis, Scratch& scratch) {
    auto& x = scratch.coordinates;
    x.clear();
    for (std::int32_t k = part.begin; k < part.end; ++k) x.push_back(items_[k].at[axis]);
    const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
    std::nth_element(x.begin(), middle, x.end());
    if (part.size() >= 64) {
      const double n = part.size();
      const auto half_strip = static_cast<std::ptrdiff_t>(std::min(5 * std::sqrt(n), 0.12 * n));
      std::nth_element(x.begin(), middle - half_strip, middle);
      std::nth_element(middle, middle + half_strip, x.end());
      const float lowest = *std::min_element(x.begin(), middle - half_strip + 1);
      if (*(middle - half_strip) > lowest) {
        return cut_in_strip(part, axis, *(middle - half_strip), *(middle + half_strip), scratch);
      }
    }
    float place = *middle;
    if (*std::min_element(x.begin(), middle + 1) == place) {  // nothing lies below
      float above = std::numeric_limits<float>::infinity();
      for (const float at : x) {
        if (at > place) above = std::min(above, at);
      }
      place = above;
    }
    return cut_in_strip(part, axis, place, place, scratch);
  }

  /// The smallest separator made of discs between `below` and `above` and of the ends of contacts that reach across.
  /// Where the strip has no width, those ends are all: a minimum vertex cover of the contacts that are cut (Koenig).
  Cut cut_in_strip(const Part& part, int axis, float below, float above, Scratch& scratch) {
    Cut cut{axis, below, {}, {}, 0};
    const bool line = below == above;
    const auto take = [&](std::int32_t disc) {
      if (strip_index_[disc] >= 0) return;
      strip_index_[disc] = static_cast<std::int32_t>(cut.strip.size());
      cut.strip.push_back(disc);
    };
    for (std::int32_t k = part.begin; k < part.end; ++k) {
      const Item& it = items_[k];
      const float at = it.at[axis];
      if (at >= above) continue;
      if (at >= below) {
        take(it.disc);
      } else if (at + it.reach[axis] >= above) {
        for (const auto& edge : graph_.of(it.disc)) {
          if (coordinates_[edge.other][axis] < above || label_of(edge.other) != part.label) continue;
          take(it.disc);
          take(edge.other);
        }
      }
    }
    VertexSeparator& separator = scratch.separator;
    separator.clear(cut.strip.size());
    for (std::size_t k = 0; k < cut.strip.size(); ++k) {
      const auto vertex = static_cast<std::int32_t>(k);
      const bool low = coordinates_[cut.strip[k]][axis] < below;
      if (line) low ? separator.touch_low(vertex) : separator.touch_high(vertex);
      for (const auto& edge : graph_.of(cut.strip[k])) {
        if (label_of(edge.other) != part.label) continue;
        const std::int32_t other = strip_index_[edge.other];
        const bool other_low = coordinates_[edge.other][axis] < below;
        if (other > vertex) {
          if (!line || low != other_low) separator.add_edge(vertex, other);
        } else if (other < 0 && !line) {
          other_low ? separator.touch_low(vertex) : separator.touch_high(vertex);
        }
      }
    }
    const auto sides = separator.solve();
    cut.sides.assign(sides.begin(), sides.end());
    cut.separator_size = separator.size();
    for (const std::int32_t disc : cut.strip) strip_index_[disc] = -1;
    return cut;
  }

  /// Append the nodes of a division in postorder. Nodes without discs are left out: their children are roots, for the
  /// caller to adopt, as is the node of `label`.
  void emit(std::int32_t label, DissectionTree& tree, std::vector<std::int32_t>& roots) {
    const Division& division = divisions_[label];
    const auto first = static_cast<std::int32_t>(tree.nodes.size());
    std::vector<std::int32_t> children;
    for (const std::int32_t child : division.children) {
      if (child >= 0) emit(child, tree, children);
    }
    if (division.begin == division.end) {
      roots.insert(roots.end(), children.begin(), children.end());
      return;
    }
    const auto self = static_cast<std::int32_t>(tree.nodes.size());
    for (const std::int32_t child : children) tree.nodes[child].parent = self;
    tree.nodes.push_back({division.begin, division.end, -1, first});
    roots.push_back(self);
  }

  const ContactGraph& graph_;
  DissectionOptions options_;
  Vec2 corner_;
  std::vector<Item> items_;
  std::vector<std::array<float, 2>> coordinates_;  // by disc
  std::vector<std::int32_t> label_;                // by disc
  std::vector<std::int32_t> strip_index_;          // by disc: place in the strip of the cut at hand, or -1
  std::vector<Division> divisions_;                // by label
  std::vector<Scratch> scratch_;                   // by worker
};

}  // namespace

DissectionTree dissect(const Assembly& assembly, const ContactGraph& graph, const DissectionOptions& options) {
  stop_if_interrupted();
  return Dissection(assembly, graph, options).run();
}

}  // namespace equidem
