// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contacts that are on a limit of their law, the next one to reach a limit, and whether their changes come to an
/// end.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "equidem/breakage/break_search.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"
#include "equidem/breakage/unbonded/contact_rates.hpp"
#include "equidem/breakage/unbonded/unbonded_state.hpp"

namespace equidem {

struct NextContactEvent {
  double t = std::numeric_limits<double>::infinity();  ///< of the parameter of the rates
  std::size_t contact = 0;
  std::optional<BreakMode> breaks;                       ///< how a bond breaks; none: another event
  std::int64_t ties = 0;                                 ///< other contacts at the same t, to 1e-10
  double gap = std::numeric_limits<double>::infinity();  ///< of t, relative, to the next contact that does not tie
};

/// The contacts on a limit of their law, in the order of their numbers; bonds are on none. At the apex are also open
/// contacts of discs that nothing else holds where the round-off of forces has moved these far to an overlap, and
/// closed ones that are pulled: rates that are round-off are no events, and add up on a long way.
std::vector<LimitContact> contacts_on_limits(const UnbondedState& state, std::span<const UnbondedLaw> laws);

/// The first contact that reaches a limit while all forces go on at these rates; t is infinite where none does.
/// \param stage t at which the rates end whatever happens. A contact without a bond that is beyond its limit by no more
///        than round-off there has not reached it: the last forces of a part that comes loose vanish exactly with
///        those of the bond that held it, and behind the stage such contacts are on their limits either way.
NextContactEvent next_contact_event(const UnbondedState& state, std::span<const UnbondedLaw> laws,
                                    const ContactStrengths& strengths, const Rates& rates, double stage);

/// Whether a path goes on: frictional contacts may change to and fro at one state for ever. Where it does not move at
/// all and statuses come again, they come for ever: the next step depends on nothing else. Where it moves within
/// round-off they may be those of gaps that close in turn, each by a part of the other one, until both are gone. One
/// set of statuses is kept, a later one whenever the number of steps has doubled (Brent's search for a cycle).
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
  void pass(PathNumbers& n) { EQUIDEM_PASS(n, kept_, steps_, until_, times_, still_); }

 private:
  std::vector<ContactStatus> kept_;
  std::int64_t steps_ = 0, until_ = 1, times_ = 0;
  bool still_ = true;  // since the kept statuses
};

}  // namespace equidem
