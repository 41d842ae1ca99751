// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A proof that contacts without bonds cannot bear a load that grows, by limit analysis.
///
/// The forces that a contact can add to those that it has form a convex cone: every direction where it sticks or is
/// bonded, N <= 0 with |T| <= -mu N where it just touches, and s T + mu N <= 0 on the limit of its friction in the
/// direction s; an open contact adds none. Loads outside of the sum of these cones are balanced by no forces, whatever
/// moves. The law itself is a convex cone, too: the contacts that are closed now balance no larger load of the kind in
/// any other state either. How contacts slip does not count, so that loads inside of the sum may not be borne either.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "equidem/breakage/unbonded/contact_law.hpp"
#include "equidem/breakage/unbonded/contact_rates.hpp"

namespace equidem {

/// A motion, per component, on which the loads work and no force that the contacts can add resists.
struct UnborneLoads {
  std::vector<double> motion;
};

/// \param status per contact, before the increment
/// \return none where contacts can bear what drives them, where it is no load, or where the network is so large that
///         it is not tried
std::optional<UnborneLoads> unborne_loads(const RateProblem& problem, std::span<const ContactStatus> status);

}  // namespace equidem
