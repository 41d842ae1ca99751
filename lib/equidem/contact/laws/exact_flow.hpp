// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Linear spring and dashpot solved exactly within the step, all contacts together (exact_contact.hpp,
/// grains/contacts/flow_step.hpp).
#pragma once

#include <numbers>

#include "equidem/contact/laws/law.hpp"

namespace equidem::laws {

struct ExactFlow : LinearSpringDashpot {
  static constexpr const char* name = "exact_flow";
  static constexpr const char* letter = "X";
  static constexpr const char* source = "";
  static constexpr const char* summary =
      "linear spring and dashpot solved exactly within the step, all contacts together";
  static constexpr LawKind kind = LawKind::simultaneous;
  static constexpr double steps_per_contact = std::numbers::pi;  ///< omega dt = 1

  static ExactPair prepare(double m, double k, double dissipation, ContactEnd end, double dt) {
    return exact_pair(m, k, dissipation / 2, end, dt);
  }
  static ExactStep step(const ExactPair& pair, double overlap, double closing, bool touching, double h0, double h1) {
    return exact_step(pair, overlap, closing, touching, h0, h1);
  }

  /// A single contact is exact at any step.
  static double stable_step(double /*damping_ratio*/) { return 0; }
};

}  // namespace equidem::laws
