// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Implementations of BreakableSystem share this: the states of a network, and its rest once contacts have broken.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/breakable_system.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"

namespace equidem {

/// The rest of a network, with its numbers in the whole.
struct RestOfNetwork {
  Assembly assembly;
  ContactSprings springs{SpringConstants{}};
  std::vector<std::int32_t> discs, contacts;  ///< of the whole, ascending
};

/// All discs and the contacts that are not broken. \param broken per contact, 1
RestOfNetwork unbroken_rest(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken);

/// The discs of the rest that can carry a force (load_bearing.hpp), and their contacts. \param held per disc, 1
RestOfNetwork load_bearing_rest(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken,
                                const std::vector<std::uint8_t>& held);

/// Discs of a network of `discs` that a rest lacks, per disc: 1.
std::vector<std::uint8_t> discs_outside(const RestOfNetwork& rest, std::size_t discs);

/// "a load drives " and the motion of a mechanism, with the numbers of discs in the whole.
/// \param rest whose discs and contacts count: what has left it may follow in more than one way
/// \param motions of all discs
std::string describe_driven(const BreakableNetwork& network, const RestOfNetwork& rest,
                            std::vector<DiscMotion> motions);

/// The states of a network that breaks, as every implementation keeps them.
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
