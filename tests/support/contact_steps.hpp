// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One step of a law for one contact, dimensionless, by the name of the law.
#pragma once

#include <cmath>
#include <stdexcept>

#include "equidem/contact/laws/normal_law.hpp"

namespace equidem::test {

/// \param first whether this is the first step of the contact; maps
inline ContactStep step_of(NormalLaw law, double depth, double closing, double a, double restitution, ContactEnd end,
                           bool first) {
  return visit_law(law, [&]<class Law>(std::type_identity<Law>) -> ContactStep {
    if constexpr (Law::facts.kind == LawKind::force) {
      const double c = Law::facts.dissipation(restitution, end) * std::sqrt(a);
      return force_step<Law>(depth, closing, a, c, end == ContactEnd::at_zero_overlap);
    } else if constexpr (Law::facts.kind == LawKind::map) {
      return Law::step(depth, closing, a, restitution, first);
    } else {
      throw std::logic_error("this law solves all contacts together");
    }
  });
}

/// Where nothing is known of the step before: the bodies were apart before they moved by sigma.
inline ContactStep step_of(NormalLaw law, double depth, double closing, double a, double restitution,
                           ContactEnd end = ContactEnd::at_zero_overlap) {
  return step_of(law, depth, closing, a, restitution, end, closing >= depth);
}

}  // namespace equidem::test
