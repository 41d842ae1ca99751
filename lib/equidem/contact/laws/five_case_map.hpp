// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The map F of Fujioka & Ushijima (2005 a): restitution at the first step of contact, accepted as it is; energy kept
/// after it.
///
/// Limit: the first step is real for every slope only where e² >= a/(1 + a).
#pragma once

#include "equidem/contact/laws/energy_map.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem::laws {

struct FiveCaseMap : Map {
  static constexpr const char* name = "five_case_map";
  static constexpr const char* letter = "F";
  static constexpr const char* source = "Fujioka & Ushijima 2005 a";
  static constexpr const char* summary = "restitution at the first step of a contact, energy kept after it";

  /// The contact leaves at once with -e sigma where s >= 1/e, else by the lower root with the energy less
  /// (1 - e²) sigma²/2; later steps as energy_map.
  /// \param first whether this is the first step of the contact
  static ContactStep step(double depth, double closing, double a, double restitution, bool first) {
    assert(depth > 0);
    if (!(first && closing > 0)) return later_step(depth, closing, a);
    const double e = restitution;
    ContactStep step;
    step.loss = (1 - e) * (1 + e) * closing * closing / 2;
    if (e * closing >= depth) {
      step.mode = 10;
      step.change = -(1 + e) * closing;
    } else {
      step.mode = 11;
      const double square = (1 + a) * (e * closing) * (e * closing) - a * depth * depth;
      step.change = -(a * depth + std::sqrt(square > 0 ? square : 0)) / (1 + a) - closing;
    }
    return step;
  }
  /// \throws Error (bad_input) naming both numbers and the remedy
  static void check_range(double a, double restitution) {
    if (restitution * restitution * (1 + a) >= a) return;
    bad_input(fmt::format("the law five_case_map is asked for restitution {:.6g} at dimensionless stiffness a = {:.6g}",
                          restitution, a),
              fmt::format("its first step has an answer only where e² >= a/(1 + a), that is e >= {:.6g}",
                          std::sqrt(a / (1 + a))),
              fmt::format("Choose energy_map, which takes any restitution, or an a of at most {:.6g}",
                          restitution * restitution / ((1 - restitution) * (1 + restitution))));
  }
};

}  // namespace equidem::laws
