// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The search for the contact that breaks next (UpdatedState::critical).
#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "equidem/core/threads.hpp"
#include "equidem/statics/breaking/updated_state.hpp"

namespace equidem {

void UpdatedState::bound_children(std::size_t number) {
  thread_local std::vector<double> motion;
  for (const std::int32_t child : (*blocks_)[number].children) {
    BlockState& state = states_[child];
    state.at_worst = state.subtree;
    if (!boundary_motion(child, motion)) continue;
    const std::size_t size = motion.size() / cases.size();
    const auto bound = [&](std::size_t p) {
      return p < cases.size() ? state.rate * blocks_->force_bound(child, std::span(motion).subspan(p * size, size)) : 0;
    };
    state.at_worst = options.skip ? state.subtree.after(bound(1), bound(0)) : Utilization{0, 0};
  }
}

CriticalContact UpdatedState::critical() {
  // Best first: the block that may contain the least load factor is brought up to date, then its children are
  // candidates. Blocks of one round are independent, and their choice does not depend on the number of threads.
  using Candidate = std::pair<double, std::int32_t>;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    if ((*blocks_)[k].parent < 0) candidates.emplace(states_[k].subtree.load_factor, static_cast<std::int32_t>(k));
  }
  open_.clear();
  double least = std::numeric_limits<double>::infinity();
  std::vector<std::int32_t> round;
  std::vector<Visit> visits;
  while (true) {
    round.clear();
    const std::size_t most = 4 + open_.size() / 4;
    const double limit = least * (1 + options.tie_tolerance);
    while (!candidates.empty() && round.size() < most && candidates.top().first <= limit) {
      round.push_back(candidates.top().second);
      candidates.pop();
    }
    if (round.empty()) break;
    visits.assign(round.size(), {});
    parallel_tasks(round.size(), [&](std::size_t k, int worker) {
      visits[k] = visit(round[k], nullptr, worker);
      bound_children(round[k]);
    });
    for (std::size_t k = 0; k < round.size(); ++k) {
      account(visits[k]);
      states_[round[k]].open = true;
      open_.push_back(round[k]);
      least = std::min(least, states_[round[k]].own.load_factor);
      for (const std::int32_t child : (*blocks_)[round[k]].children) {
        candidates.emplace(states_[child].at_worst.load_factor, child);
      }
    }
  }
  const CriticalContact found = least_of_open(least);
  for (auto k = open_.rbegin(); k != open_.rend(); ++k) {  // children first
    BlockState& state = states_[*k];
    state.subtree = state.own;
    for (const std::int32_t child : (*blocks_)[*k].children) {
      state.subtree.include(states_[child].open ? states_[child].subtree : states_[child].at_worst);
    }
  }
  for (const std::int32_t k : open_) states_[k].open = false;
  return found;
}

CriticalContact UpdatedState::least_of_open(double least) {
  CriticalContact found;
  if (least == std::numeric_limits<double>::infinity()) return found;
  const double limit = least * (1 + options.tie_tolerance);
  std::int64_t reached = 0;
  for (const std::int32_t k : open_) {
    if (states_[k].own.load_factor > limit) continue;
    const MotionBlock& block = (*blocks_)[k];
    for (std::int64_t c = block.contacts_begin; c < block.contacts_end; ++c) {
      const BreakingPoint at = breaking_point(contacts_[c].force, contacts_[c].strength, options.friction);
      if (at.load_factor > limit) continue;
      ++reached;
      const std::int32_t number = blocks_->contacts()[c];
      if (found.contact < 0 || number < found.contact) found.at = at, found.contact = number;
    }
  }
  found.ties = reached - 1;
  return found;
}

}  // namespace equidem
