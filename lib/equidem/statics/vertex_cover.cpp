// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/vertex_cover.hpp"

#include <algorithm>

namespace equidem {
namespace {

std::int32_t index_in(const std::vector<std::int32_t>& sorted, std::int32_t value) {
  return static_cast<std::int32_t>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

void sort_unique(std::vector<std::int32_t>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

void VertexCover::index_vertices() {
  std::sort(edges_.begin(), edges_.end());
  lows_.clear();
  highs_.clear();
  for (const auto& [low, high] : edges_) {
    lows_.push_back(low);
    highs_.push_back(high);
  }
  sort_unique(lows_);
  sort_unique(highs_);
  first_.assign(lows_.size() + 1, 0);
  neighbours_.clear();
  std::size_t low = 0;
  for (const auto& edge : edges_) {
    while (lows_[low] != edge.first) first_[++low] = static_cast<std::int32_t>(neighbours_.size());
    neighbours_.push_back(index_in(highs_, edge.second));
  }
  first_[lows_.size()] = static_cast<std::int32_t>(neighbours_.size());
}

void VertexCover::match_greedily() {
  match_of_low_.assign(lows_.size(), -1);
  match_of_high_.assign(highs_.size(), -1);
  for (std::size_t low = 0; low < lows_.size(); ++low) {
    for (std::int32_t e = first_[low]; e < first_[low + 1]; ++e) {
      if (match_of_high_[neighbours_[e]] >= 0) continue;
      match_of_high_[neighbours_[e]] = static_cast<std::int32_t>(low);
      match_of_low_[low] = neighbours_[e];
      break;
    }
  }
}

// Depth first along alternating paths, without recursion: path_ holds the lows on the way, cursor_ the edge
// each stands at.
bool VertexCover::augment_from(std::int32_t start) {
  ++round_;
  path_.assign(1, start);
  cursor_[start] = first_[start];
  while (!path_.empty()) {
    const std::int32_t low = path_.back();
    if (cursor_[low] == first_[low + 1]) {
      path_.pop_back();
      if (!path_.empty()) ++cursor_[path_.back()];
      continue;
    }
    const std::int32_t high = neighbours_[cursor_[low]];
    if (visited_[high] == round_) {
      ++cursor_[low];
      continue;
    }
    visited_[high] = round_;
    const std::int32_t next = match_of_high_[high];
    if (next >= 0) {
      path_.push_back(next);
      cursor_[next] = first_[next];
      continue;
    }
    for (const std::int32_t on_path : path_) {
      const std::int32_t its_high = neighbours_[cursor_[on_path]];
      match_of_low_[on_path] = its_high;
      match_of_high_[its_high] = on_path;
    }
    return true;
  }
  return false;
}

std::vector<std::int32_t> VertexCover::smallest() {
  index_vertices();
  match_greedily();
  visited_.assign(highs_.size(), 0);
  cursor_.assign(lows_.size(), 0);
  round_ = 0;
  for (std::size_t low = 0; low < lows_.size(); ++low) {
    if (match_of_low_[low] < 0) augment_from(static_cast<std::int32_t>(low));
  }

  // Koenig: with Z all that alternating paths from unmatched lows reach, the cover is (lows not in Z) and
  // (highs in Z).
  std::vector<char> low_reached(lows_.size(), 0), high_reached(highs_.size(), 0);
  path_.clear();
  for (std::size_t low = 0; low < lows_.size(); ++low) {
    if (match_of_low_[low] >= 0) continue;
    low_reached[low] = 1;
    path_.push_back(static_cast<std::int32_t>(low));
  }
  while (!path_.empty()) {
    const std::int32_t low = path_.back();
    path_.pop_back();
    for (std::int32_t e = first_[low]; e < first_[low + 1]; ++e) {
      const std::int32_t high = neighbours_[e];
      if (high_reached[high] != 0) continue;
      high_reached[high] = 1;
      const std::int32_t next = match_of_high_[high];
      if (next >= 0 && low_reached[next] == 0) {
        low_reached[next] = 1;
        path_.push_back(next);
      }
    }
  }
  std::vector<std::int32_t> cover;
  for (std::size_t low = 0; low < lows_.size(); ++low) {
    if (low_reached[low] == 0) cover.push_back(lows_[low]);
  }
  for (std::size_t high = 0; high < highs_.size(); ++high) {
    if (high_reached[high] != 0) cover.push_back(highs_[high]);
  }
  return cover;
}

}  // namespace equidem
