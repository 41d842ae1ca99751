// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The search for the contact that breaks next (UpdatedState::critical).
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "equidem/core/threads.hpp"
#include "equidem/statics/breaking/updated_state.hpp"

namespace equidem {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// The least of all keys, and one that does not tie with it and is none greater than the next such one.
struct LeastKeys {
  const LoadFactorSearch& search;
  double least = never, second = never;

  void include(double key) {
    if (key == never) return;
    if (key < least) {
      if (least - key > tie_distance(key, search)) second = least;
      least = key;
    } else if (key - least > tie_distance(least, search)) {
      second = std::min(second, key);
    }
  }
};

}  // namespace

std::array<double, 2> UpdatedState::keys_of(std::size_t number, const LoadFactorSearch& search) const {
  LeastKeys keys{search};
  const MotionBlock& block = (*blocks_)[number];
  for (std::int64_t c = block.contacts_begin; c < block.contacts_end; ++c) keys.include(moment_of(c, search).key());
  return {keys.least, keys.second};
}

FirstToBreak UpdatedState::critical(const LoadFactorSearch& search) {
  if (search.direction != search_.direction || search.no_live != search_.no_live || search.no_dead != search_.no_dead) {
    search_ = search;
    bring_all_up_to_date();
    evaluate_blocks();
  }
  // Best first: the block that may contain the least key is brought up to date, then its children are candidates.
  // Blocks of one round are independent, and their choice does not depend on the number of threads.
  using Candidate = std::pair<double, std::int32_t>;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    if ((*blocks_)[k].parent < 0) candidates.emplace(states_[k].subtree.least_key(search), k);
  }
  open_.clear();
  LeastKeys keys{search};
  std::vector<std::int32_t> round;
  std::vector<Visit> visits;
  std::vector<std::array<double, 2>> found;
  while (true) {
    round.clear();
    const std::size_t most = 4 + open_.size() / 4;
    while (!candidates.empty() && round.size() < most && candidates.top().first <= keys.second &&
           candidates.top().first < never) {
      round.push_back(candidates.top().second);
      candidates.pop();
    }
    if (round.empty()) break;
    visits.assign(round.size(), {});
    found.assign(round.size(), {never, never});
    parallel_tasks(round.size(), [&](std::size_t k, int worker) {
      visits[k] = visit(round[k], nullptr, worker);
      if (states_[round[k]].own.least_key(search) <= keys.second) found[k] = keys_of(round[k], search);
      bound_children(round[k]);
    });
    for (std::size_t k = 0; k < round.size(); ++k) {
      account(visits[k]);
      counters.fronts += visits[k].fronts;
      states_[round[k]].open = true;
      open_.push_back(round[k]);
      for (const double key : found[k]) keys.include(key);
      for (const std::int32_t child : (*blocks_)[round[k]].children)
        candidates.emplace(states_[child].at_worst.least_key(search), child);
    }
  }
  counters.all_fronts += static_cast<std::int64_t>(symbolic_->fronts());
  const FirstToBreak first = first_of_open(search, keys.second);
  for (auto k = open_.rbegin(); k != open_.rend(); ++k) {  // children first
    BlockState& state = states_[*k];
    state.subtree = state.own;
    for (const std::int32_t child : (*blocks_)[*k].children) {
      state.subtree.include(states_[child].open ? states_[child].subtree : states_[child].at_worst);
    }
  }
  for (const std::int32_t k : open_) states_[k].open = false;
  return first;
}

std::vector<double> UpdatedState::least_keys(const LoadFactorSearch& search) const {
  std::vector<double> keys(contacts_.size()), of_subtree(states_.size());
  std::vector<std::uint8_t> open(states_.size(), 0);
  for (const std::int32_t k : open_) open[k] = 1;
  for (std::size_t k = states_.size(); k-- > 0;) {  // parents before their children
    const MotionBlock& block = (*blocks_)[k];
    const bool below_open = block.parent >= 0 && open[block.parent] != 0;
    if (open[k] == 0) {
      of_subtree[k] = block.parent < 0 ? states_[k].subtree.least_key(search)
                      : below_open     ? states_[k].at_worst.least_key(search)
                                       : of_subtree[block.parent];
    }
    for (std::int64_t c = block.contacts_begin; c < block.contacts_end; ++c)
      keys[blocks_->contacts()[c]] = open[k] != 0 ? moment_of(c, search).key() : of_subtree[k];
  }
  return keys;
}

FirstToBreak UpdatedState::first_of_open(const LoadFactorSearch& search, double limit) const {
  std::vector<std::pair<BreakingMoment, std::int64_t>> contacts;
  for (const std::int32_t k : open_) {
    if (states_[k].own.least_key(search) > limit + tie_distance(limit, search)) continue;  // to round-off of `own`
    const MotionBlock& block = (*blocks_)[k];
    for (std::int64_t c = block.contacts_begin; c < block.contacts_end; ++c) {
      const BreakingMoment moment = moment_of(c, search);
      if (moment.key() <= limit) contacts.emplace_back(moment, blocks_->contacts()[c]);
    }
  }
  return FirstToBreak::among(
      contacts.size(), [&](std::size_t k) { return contacts[k].first; },
      [&](std::size_t k) { return contacts[k].second; }, search);
}

}  // namespace equidem
