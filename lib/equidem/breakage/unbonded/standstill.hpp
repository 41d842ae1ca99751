// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Whether a path goes on: contacts that rub may change to and fro at one state for ever.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/breakage/path_numbers.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"

namespace equidem {

/// Where the path does not move and statuses come again, they come for ever: the next step depends on nothing else.
/// One set of statuses is kept, a later one whenever the number of steps has doubled (Brent's search for a cycle).
class Standstill {
 public:
  /// \param of what t is a part of, > 0: less than 1e-12 of it is round-off
  /// \return whether the path moved
  bool moved(double t, double of) {
    if (!(t > 1e-12 * of)) return false;
    begin();
    return true;
  }
  void begin() {
    kept_.clear();
    steps_ = 0;
    until_ = 1;
  }
  /// \return whether these statuses were there before since the path last moved
  bool again(std::span<const ContactStatus> status) {
    if (!kept_.empty() && std::ranges::equal(kept_, status)) return true;
    if (++steps_ < until_) return false;
    kept_.assign(status.begin(), status.end());
    steps_ = 0;
    until_ *= 2;
    return false;
  }
  void pass(PathNumbers& n) { n.pass(kept_, steps_, until_); }

 private:
  std::vector<ContactStatus> kept_;
  std::int64_t steps_ = 0, until_ = 1;
};

}  // namespace equidem
