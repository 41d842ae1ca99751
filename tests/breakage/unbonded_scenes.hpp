// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Paths of networks with unbonded contacts, with all that they refer to.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "equidem/breakage/unbonded/unbonded_run.hpp"

#include "breakage/scenes.hpp"

namespace equidem::test {

class Unbonded : public OwnedScene {
 public:
  Unbonded(Assembly assembly, ContactSprings springs, ContactStrengths strengths, const LoadPathOptions& options,
           UnbondedOptions unbonded, Rotation rotation = Rotation::from_scene)
      : OwnedScene(std::move(assembly), std::move(springs), std::move(strengths), options, rotation),
        run_(scene(), effects(), supports(), std::move(unbonded)) {}
  /// No contact is a bond.
  Unbonded(const Assembly& assembly, ContactSprings springs, const LoadPathOptions& options, double friction)
      : Unbonded(assembly, std::move(springs), equal_strengths(assembly, 0, 0), options, {friction, {}}) {}

  UnbondedRun& run() { return run_; }
  const std::vector<BreakEvent>& events() const { return run_.events(); }
  const BreakEvent& event(std::size_t k) const { return events().at(k); }

  Unbonded& all() {
    while (run_.advance()) {
    }
    return *this;
  }

 private:
  UnbondedRun run_;
};

/// The sum of the ways of all components, m, along straight pieces.
class Way {
 public:
  explicit Way(std::vector<double> from) : at_(std::move(from)) {}
  void go_to(const std::vector<double>& to) {
    for (std::size_t k = 0; k < to.size(); ++k) length_ += std::abs(to[k] - at_[k]);
    at_ = to;
  }
  [[nodiscard]] double length() const { return length_; }

 private:
  std::vector<double> at_;
  double length_ = 0;
};

}  // namespace equidem::test
