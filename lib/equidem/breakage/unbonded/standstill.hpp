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

/// Where the path does not move at all and statuses come again, they come for ever: the next step depends on nothing
/// else. Where it moves within round-off they may be those of gaps that close in turn, each by a part of the other one,
/// until both are gone. One set of statuses is kept, a later one whenever the number of steps has doubled (Brent's
/// search for a cycle).
class Standstill {
 public:
  /// \param of what t is a part of, > 0: less than 1e-12 of it is round-off
  /// \return whether the path moved
  bool moved(double t, double of) {
    if (!(t > 1e-12 * of)) {
      if (t > 0) still_ = false;
      return false;
    }
    begin();
    return true;
  }
  void begin() { *this = {}; }
  /// \return whether these statuses come for ever: they were there before since the path last moved
  bool again(std::span<const ContactStatus> status) {
    constexpr int most_times = 20;  // with moves within round-off
    if (!kept_.empty() && std::ranges::equal(kept_, status)) {
      if (still_ || ++times_ == most_times) return true;
      still_ = true;
      return false;
    }
    if (++steps_ < until_) return false;
    kept_.assign(status.begin(), status.end());
    steps_ = 0;
    until_ *= 2;
    still_ = true;
    return false;
  }
  void pass(PathNumbers& n) { n.pass(kept_, steps_, until_, times_, still_); }

 private:
  std::vector<ContactStatus> kept_;
  std::int64_t steps_ = 0, until_ = 1, times_ = 0;
  bool still_ = true;  // since the kept statuses
};

}  // namespace equidem
