// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A proof that a state of contacts that slip is unstable: a motion that grows by itself.
///
/// Springs of c at every component make the rates of a load unique where c is large. With less c they grow without
/// bound where F_int(w) + c w = 0 for some motion w, whose contacts slip and stick as the law asks. Where discs
/// move in a medium that resists them by eta per speed, u = w exp(c t/eta) then is a motion without any load: a
/// disturbance grows. Stiffness that is not symmetric, of contacts that slip, can have such c > 0 although forces that
/// balance the load exist.
#pragma once

#include <optional>
#include <vector>

#include "equidem/breakage/unbonded/contact_rates.hpp"

namespace equidem {

struct GrowingMotion {
  std::vector<double> motion;  ///< w, per component
  double stiffness = 0;        ///< c over the stiffest spring
};

/// \return none where no such motion is found on the way of the rates from large to small c, or where the motion of
///         loads is prescribed
std::optional<GrowingMotion> growing_motion(const RateProblem& problem, const std::vector<ContactStatus>& status);

}  // namespace equidem
