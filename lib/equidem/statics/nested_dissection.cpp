// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/nested_dissection.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/core/threads.hpp"
#include "equidem/statics/vertex_cover.hpp"

namespace equidem {
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

/// What became of a part: it eliminates items [begin, end) after its children, which are named by their
/// labels.
struct Division {
  std::int32_t begin = 0, end = 0;
  std::array<std::int32_t, 2> children{-1, -1};
};

struct Cut {
  int axis = 0;
  float place = 0;                      ///< the low side is below it
  std::vector<std::int32_t> separator;  ///< discs
};

struct Scratch {
  std::vector<float> coordinates;
  std::vector<Item> items;
  VertexCover cover;
};

constexpr std::int32_t separated = -1;  // label of a disc that is in a separator

class Dissection {
 public:
  Dissection(const Assembly& assembly, const ContactGraph& graph, const DissectionOptions& options)
      : graph_(graph),
        options_(options),
        items_(graph.size()),
        coordinates_(graph.size()),
        label_(graph.size(), 0),
        divisions_(2 * graph.size() + 1) {
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
    emit(0, tree);
    return tree;
  }

 private:
  Item item(const Assembly& assembly, std::size_t d) const {
    const Vec2 x = assembly.centres[d];
    Vec2 reach;
    for (const auto& edge : graph_.of(d)) {
      const Vec2 y = assembly.centres[edge.other];
      reach.x = std::max(reach.x, std::abs(y.x - x.x));
      reach.y = std::max(reach.y, std::abs(y.y - x.y));
    }
    // Rounding to single precision must not let the reach come out short.
    const auto generous = [](double r, double at) {
      return static_cast<float>(1.000001 * r + 1e-6 * std::abs(at));
    };
    return {{static_cast<float>(x.x), static_cast<float>(x.y)},
            {generous(reach.x, x.x), generous(reach.y, x.y)},
            static_cast<std::int32_t>(d)};
  }

  // Threads read labels of discs that belong to other threads' parts; whatever they read, it is not their own
  // label.
  std::int32_t label_of(std::int32_t disc) {
    return std::atomic_ref(label_[disc]).load(std::memory_order_relaxed);
  }
  void set_label(std::int32_t disc, std::int32_t label) {
    std::atomic_ref(label_[disc]).store(label, std::memory_order_relaxed);
  }

  /// Large parts level by level, each level in parallel; then the small ones, each by one thread to its
  /// leaves.
  void divide_all(Part root) {
    constexpr std::int32_t small = 20000;
    std::vector<Part> level{root}, small_parts;
    while (!level.empty()) {
      std::vector<std::vector<Part>> children(level.size());
      parallel_tasks(level.size(), [&](std::size_t k, int) { divide(level[k], children[k]); });
      level.clear();
      for (const auto& parts : children) {
        for (const Part& part : parts) (part.size() > small ? level : small_parts).push_back(part);
      }
    }
    parallel_tasks(small_parts.size(), [&](std::size_t k, int) {
      std::vector<Part> open{small_parts[k]};
      while (!open.empty()) {
        const Part part = open.back();
        open.pop_back();
        divide(part, open);
      }
    });
  }

  /// Divide a part and append its children. A binary tree over n discs has at most 2n - 1 nodes: a part of n
  /// discs owns the labels [label, label + 2n - 1), so that parts can be divided in any order.
  void divide(const Part& part, std::vector<Part>& open) {
    thread_local Scratch scratch;
    Division& division = divisions_[part.label];
    division = {part.begin, part.end, {-1, -1}};
    if (part.size() <= std::max(1, options_.leaf_size)) return;
    const Cut cut = best_cut(part, scratch);
    const auto is_low = [&](const Item& it) { return it.at[cut.axis] < cut.place; };
    for (const std::int32_t disc : cut.separator) set_label(disc, separated);

    std::array<std::int32_t, 3> counts{};  // low side, high side, separator
    for (std::int32_t k = part.begin; k < part.end; ++k) ++counts[side_of(items_[k], is_low(items_[k]))];
    if (counts[0] == part.size() || counts[1] == part.size() || counts[2] == part.size())
      return;  // discs coincide
    const Part low{part.begin, part.begin + counts[0], part.label + 1};
    const Part high{low.end, low.end + counts[1], low.label + std::max(0, 2 * counts[0] - 1)};

    scratch.items.assign(items_.begin() + part.begin, items_.begin() + part.end);
    std::array<std::int32_t, 3> next{low.begin, high.begin, high.end};
    for (const Item& it : scratch.items) {
      const int side = side_of(it, is_low(it));
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

  int side_of(const Item& it, bool low) { return label_of(it.disc) == separated ? 2 : low ? 0 : 1; }

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
      if (other.separator.size() < cut.separator.size()) cut = std::move(other);
    }
    return cut;
  }

  /// A cut across `axis` at the median coordinate, or above it where nothing lies below, and its smallest
  /// separator.
  Cut median_cut(const Part& part, int axis, Scratch& scratch) {
    auto& x = scratch.coordinates;
    x.clear();
    for (std::int32_t k = part.begin; k < part.end; ++k) x.push_back(items_[k].at[axis]);
    const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
    std::nth_element(x.begin(), middle, x.end());
    float place = *middle;
    if (*std::min_element(x.begin(), middle + 1) == place) {
      float above = std::numeric_limits<float>::infinity();
      for (const float at : x) {
        if (at > place) above = std::min(above, at);
      }
      place = above;
    }
    return {axis, place, smallest_separator(part, axis, place, scratch)};
  }

  std::vector<std::int32_t> smallest_separator(const Part& part, int axis, float place, Scratch& scratch) {
    scratch.cover.clear();
    for (std::int32_t k = part.begin; k < part.end; ++k) {
      const Item& it = items_[k];
      if (it.at[axis] >= place || it.at[axis] + it.reach[axis] < place) continue;
      for (const auto& edge : graph_.of(it.disc)) {
        if (coordinates_[edge.other][axis] >= place && label_of(edge.other) == part.label) {
          scratch.cover.add_edge(it.disc, edge.other);
        }
      }
    }
    return scratch.cover.smallest();
  }

  /// Append the nodes of a division in postorder; nodes without discs are left out. The index of the node of
  /// `label`, or -1 where it is left out and its children stay without a parent here; they are then adopted
  /// by the caller.
  void emit(std::int32_t label, DissectionTree& tree) {
    std::vector<std::int32_t> orphans;  // roots that wait for a parent
    emit(label, tree, orphans);
  }
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
  std::vector<Item> items_;
  std::vector<std::array<float, 2>> coordinates_;  // by disc
  std::vector<std::int32_t> label_;                // by disc
  std::vector<Division> divisions_;                // by label
};

}  // namespace

DissectionTree dissect(const Assembly& assembly, const ContactGraph& graph,
                       const DissectionOptions& options) {
  return Dissection(assembly, graph, options).run();
}

}  // namespace equidem
