// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The states of a network that breaks, as every implementation of BreakableSystem keeps them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "equidem/breakage/breakable_system.hpp"

namespace equidem {

class SolvedStates : public BreakableSystem {
 public:
  [[nodiscard]] std::span<const ContactForce> forces(std::size_t k) const override { return states_[k].forces; }
  [[nodiscard]] std::span<const double> motion(std::size_t k) const override { return states_[k].motion; }
  [[nodiscard]] std::span<const double> reactions(std::size_t k) const override { return states_[k].reactions; }
  [[nodiscard]] std::optional<NextBreak> next_break(const ContactStrengths& strengths,
                                                    const LoadFactorSearch& search) override {
    return equidem::next_break(forces(0), states_.size() > 1 ? forces(1) : std::span<const ContactForce>{}, strengths,
                               search);
  }
  [[nodiscard]] bool carries(std::size_t k) const override { return states_[k].carried; }
  [[nodiscard]] std::string why_not() const override { return why_not_; }
  [[nodiscard]] std::span<const std::uint8_t> left() const override { return left_; }
  [[nodiscard]] double relative_residual() const override { return residual_; }

 protected:
  struct State {
    std::vector<ContactForce> forces;
    std::vector<double> motion, reactions;
    bool carried = true;
  };

  SolvedStates(std::size_t cases, std::size_t discs) : states_(cases), left_(discs, 0) {}
  /// \param residual of the network as it is
  void measured(double residual) {
    residual_ = residual;
    largest_residual_ = std::max(largest_residual_, residual);
  }
  [[nodiscard]] double largest_residual() const { return largest_residual_; }

  mutable std::vector<State> states_;  // an implementation may fill them when they are asked for
  std::vector<std::uint8_t> left_;
  std::string why_not_;

 private:
  double residual_ = 0, largest_residual_ = 0;
};

}  // namespace equidem
