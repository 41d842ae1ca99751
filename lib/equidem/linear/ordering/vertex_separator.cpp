// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/ordering/vertex_separator.hpp"

#include <algorithm>

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

}  // namespace equidem
