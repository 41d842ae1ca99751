// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Paths of frictional contacts against those by dense matrices: the bonds that break, and the forces of all contacts.
///
/// Statuses of contacts are not compared: those of a contact that touches without a force are names, as are those that
/// a contact passes through without anything moving, and events at one lambda have no order. Whatever of them matters
/// shows in the forces of a later state.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "breakage/dense_unbonded.hpp"
#include "breakage/unbonded_scenes.hpp"

namespace equidem::test {

/// The way of lambda to a state, as DenseUnbonded::State1 counts it.
inline double way_of(const UnbondedState& state, const LoadPath& path, std::int64_t leg) {
  if (path.dead && state.dead() < 1) return state.dead() - 1;
  double way = 0, from = 0;
  for (std::int64_t k = 0; k < leg; ++k) {
    way += std::abs(path.legs[static_cast<std::size_t>(k)] - from);
    from = path.legs[static_cast<std::size_t>(k)];
  }
  return way + std::abs(state.lambda() - from);
}

class DenseStates {
 public:
  explicit DenseStates(const DenseUnbonded& dense) : states_(dense.states) {}

  /// The largest difference of a force, N/m, to the nearest state at this place of the way: there are several where
  /// bonds break. Between two states forces are linear.
  /// \param before gets the number of events before that state
  [[nodiscard]] double difference(double way, std::span<const ContactForce> forces, std::size_t& before) const {
    constexpr double same = 1e-9;
    double least = std::numeric_limits<double>::infinity();
    std::size_t next = 0;
    for (std::size_t k = 0; k < states_.size(); ++k) {
      if (states_[k].way <= way) next = k + 1;
      if (std::abs(states_[k].way - way) > same) continue;
      const double d = largest_difference(states_[k].forces, forces);
      if (d < least) least = d, before = states_[k].events;
    }
    if (std::isfinite(least) || states_.empty() || next == states_.size()) return least;
    std::vector<ContactForce> between(forces.size());  // before the first state there are the forces at rest
    if (next == 0) return least;
    const auto &a = states_[next - 1], &b = states_[next];
    const double share = (way - a.way) / (b.way - a.way);
    for (std::size_t c = 0; c < between.size(); ++c) {
      between[c] = {a.forces[c].normal + share * (b.forces[c].normal - a.forces[c].normal),
                    a.forces[c].tangential + share * (b.forces[c].tangential - a.forces[c].tangential)};
    }
    before = a.events;
    return largest_difference(between, forces);
  }

 private:
  static double largest_difference(std::span<const ContactForce> a, std::span<const ContactForce> b) {
    double most = 0;
    for (std::size_t c = 0; c < a.size(); ++c)
      most = std::max({most, std::abs(a[c].normal - b[c].normal), std::abs(a[c].tangential - b[c].tangential)});
    return most;
  }

  const std::vector<DenseUnbonded::State1>& states_;
};

/// Why two paths were compared no further.
enum class ComparedUntil {
  end,       ///< of the path
  loose,     ///< a disc that nothing holds may be anywhere
  no_dense,  ///< dense matrices found no rates: pivots ended, and combinations were many
  falling,   ///< the path ended while a bond let go: everything falls
  differs,   ///< forces are not the same
};

struct ComparedPaths {
  ComparedUntil until = ComparedUntil::end;
  std::size_t states = 0;  ///< that have the same forces
  std::size_t events = 0;  ///< of the path up to the last of them
  double largest = 0;      ///< difference of forces of these, over the largest force so far
  double way = 0;          ///< of the last state looked at
  double difference = 0;   ///< likewise, there
};

/// \param ours not begun
/// \param most events
inline ComparedPaths compare_forces(Unbonded& ours, DenseUnbonded& dense, std::size_t most) {
  constexpr double same = 1e-8;
  using enum ComparedUntil;
  const bool found = dense.go(most + 50);
  const DenseStates states(dense);
  const auto& legs = ours.path().legs;
  ComparedPaths result;
  const auto stop = [&](ComparedUntil why) {
    result.until = why;
    return result;
  };
  while (ours.events().size() < most) {
    const std::size_t first = ours.events().size();
    bool more = ours.run().advance();
    while (more && ours.run().releasing()) more = ours.run().advance();
    if (!more && ours.run().end() != PathEnd::legs_done && ours.events().size() == first) break;
    const UnbondedState& state = ours.run().contact_state();
    if (!state.releasing().empty()) return stop(falling);
    const std::span fresh = std::span(ours.events()).subspan(first);
    const std::int64_t leg = !fresh.empty() ? fresh.back().leg : std::ssize(legs) - 1;
    result.way = way_of(state, ours.path(), leg);
    if (dense.determined == 0) return stop(loose);
    if (dense.states.empty() || result.way > dense.states.back().way + 1e-9) return stop(found ? differs : no_dense);
    std::size_t before = 0;
    result.difference = states.difference(result.way, state.forces(), before) / state.largest_force();
    if (before > dense.determined) return stop(loose);
    // Where all forces so far are round-off of the motions there is nothing to compare.
    const bool forces = state.negligible_force() < 4e-5 * state.largest_force();
    if (forces && !(result.difference <= same)) {
      const bool at_end = !found && result.way >= dense.states.back().way - 1e-9;
      return stop(at_end ? no_dense : differs);
    }
    if (forces) result.largest = std::max(result.largest, result.difference);
    ++result.states;
    result.events = ours.events().size();
    if (!more) break;
  }
  return result;
}

}  // namespace equidem::test
