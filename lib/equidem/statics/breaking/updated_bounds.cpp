// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How near to breaking the contacts of a part may be: as of its last visit, and after what has changed since then.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "equidem/core/threads.hpp"
#include "equidem/statics/breaking/updated_state.hpp"

namespace equidem {
namespace {

constexpr std::size_t blocks_at_once = 1 << 4;

}  // namespace

double UpdatedState::rate_of(const BreakingContact& contact) const {
  return utilization_rate(contact.springs, contact.strength, options.friction);
}

void UpdatedState::class_contacts() {
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const MotionBlock& block = (*blocks_)[k];
    for (std::int64_t c = block.contacts_begin; c < block.contacts_end; ++c) {
      const ContactStrength& strength = contacts_[c].strength;
      states_[k].rate = std::max(states_[k].rate, rate_of(contacts_[c]));
      if (strength.shear > 0) states_[k].pressed = std::max(states_[k].pressed, options.friction / strength.shear);
    }
    for (const std::int32_t child : block.children) states_[k].rate = std::max(states_[k].rate, states_[child].rate);
  }
  // A contact without strength has an infinite rate; it is of the first class, and looked at as soon as it carries.
  for (const BreakingContact& contact : contacts_) {
    if (std::isfinite(rate_of(contact))) largest_rate_ = std::max(largest_rate_, rate_of(contact));
  }
  for (std::size_t slot = 0; slot < contacts_.size(); ++slot) {
    const double rate = rate_of(contacts_[slot]);
    if (rate > 0) classes_[slot] = static_cast<std::uint8_t>(rate_class(rate, largest_rate_));
  }
}

void UpdatedState::evaluate_block(std::size_t number) {
  const MotionBlock& block = (*blocks_)[number];
  BlockState& state = states_[number];
  const auto begin = static_cast<std::size_t>(block.contacts_begin);
  const std::size_t count = static_cast<std::size_t>(block.contacts_end) - begin;
  const auto forces = [&](std::size_t p) {
    return p < forces_.size() ? std::span<const ContactForce>(forces_[p]).subspan(begin, count)
                              : std::span<const ContactForce>{};
  };
  state.own = utilization_of(std::span(contacts_).subspan(begin, count), forces(0), forces(1),
                             std::span(classes_).subspan(begin, count), options.friction, search_.direction);
  // A compression that counts as 0 adds nothing to the strength in shear.
  const double dead = state.pressed * std::max(search_.no_dead, 0.0);
  const double live = state.pressed * std::max(search_.no_live, 0.0);
  for (Utilization& one : state.own.of) one = one.after(dead, live);
}

void UpdatedState::evaluate_blocks() {
  parallel_ranges(states_.size(), blocks_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) evaluate_block(k);
  });
  include_subtrees();
}

void UpdatedState::include_subtrees() {
  for (std::size_t k = 0; k < states_.size(); ++k) {  // children before their parents
    states_[k].subtree = states_[k].own;
    for (const std::int32_t child : (*blocks_)[k].children) states_[k].subtree.include(states_[child].subtree);
  }
}

// The motion x that follows a change has the energy x.K x = |L^-1 f|², over the fronts of the path. On a subtree T of
// the path it is a motion with the boundary at rest, which has the share of the fronts in T, and one that follows the
// boundary; the two are orthogonal in energy. All that is outside T therefore has no more than the share of the fronts
// above T.
void UpdatedState::reach_beside(const FactorPath& path) {
  constexpr double margin = 1 + 1e-6, of_whole = 1e-11;  // for round-off
  const std::size_t fronts = path.fronts.size();
  std::vector<std::array<double, 2>> above(fronts);  // the share of each front and those above it
  const double* y = path.values.data() + path.values.size();
  for (std::size_t f = fronts; f-- > 0;) {
    if (f + 1 < fronts) above[f] = above[f + 1];
    const std::size_t pivots = symbolic_->pivots(path.fronts[f]);
    y -= pivots * cases.size();
    for (std::size_t p = 0; p < cases.size(); ++p) {
      for (std::size_t k = 0; k < pivots; ++k) above[f][p] += squared(y[p * pivots + k]);
    }
  }
  std::int32_t below = -1;
  for (std::size_t f = 0; f < fronts; ++f) {
    const std::int32_t block = blocks_->of_front(path.fronts[f]);
    if (block == below) continue;
    for (const std::int32_t child : (*blocks_)[block].children) {
      if (child == below) continue;
      for (std::size_t p = 0; p < cases.size(); ++p)
        states_[child].reached[p] += margin * std::sqrt(above[f][p]) + of_whole * std::sqrt(above[0][p]);
    }
    below = block;
  }
}

void UpdatedState::bound_children(std::size_t number) {
  thread_local std::vector<double> motion;
  for (const std::int32_t child : (*blocks_)[number].children) {
    BlockState& state = states_[child];
    state.at_worst = options.skip ? state.subtree : ClassedUtilization::unknown();
    const bool moved = whole_boundary_motion(child, motion);
    if (!options.skip || !(moved || state.to_correct)) continue;
    std::array<double, 2> change = state.reached;
    const std::size_t size = motion.size() / cases.size();
    for (std::size_t p = 0; p < cases.size(); ++p)
      change[p] = std::min(change[p],
                           blocks_->force_bound(child, std::span(motion).subspan(p * size, size)) + state.corrected[p]);
    double rate = largest_rate_;
    for (std::size_t c = 0; c < rate_classes; ++c, rate *= 0.5) {
      const double most = std::isfinite(state.rate) ? std::min(rate, state.rate) : state.rate;
      const auto by = [&](double energy) { return energy > 0 ? most * energy : 0; };
      state.at_worst.of[c] = state.subtree.of[c].after(by(change[1]), by(change[0]));
    }
  }
}

}  // namespace equidem
