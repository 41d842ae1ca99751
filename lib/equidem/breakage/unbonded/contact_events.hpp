// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contacts that are on a limit of their law, and the next one to reach a limit.
#pragma once

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

}  // namespace equidem
