// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A motion that contacts on their limits do not resist, although forces that balance the load exist.
///
/// Springs of c at every component make the rates v of a load unique where c is large. Where no rates answer the load,
/// c v does not vanish with c:
///
///   c v tends to w as c vanishes             F_int(w) = 0: a mechanism of contacts that slip and open, which the load
///                                            drives
///   v grows without bound as c falls to c_0  F_int(w) + c_0 w = 0 for its direction w
///
/// The contacts of w slip, stick and open as the law asks. In a medium that resists discs by eta per speed, u = w
/// exp(c_0 t/eta) is a motion without any load: a disturbance grows. The stiffness of contacts that slip is not
/// symmetric; that of others has no such c_0 > 0.
#pragma once

#include <optional>
#include <vector>

#include "equidem/breakage/unbonded/contact_rates.hpp"

namespace equidem {

struct UnresistedMotion {
  std::vector<double> motion;  ///< w, per component
  double growth = 0;           ///< c_0 over the stiffest spring; 0: the load drives a mechanism
};

/// \return none where neither is found on the way of the rates from large to small c, where the motion of loads is
///         prescribed, or where contacts on limits are too many (most_on_limits)
std::optional<UnresistedMotion> unresisted_motion(const RateProblem& problem, const std::vector<ContactStatus>& status);

}  // namespace equidem
