// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbers of independent motions without resistance.
#pragma once

#include <cstdint>

#include "equidem/statics/rigid_motions.hpp"

namespace equidem {

struct RigidityReport {
  std::int64_t pieces = 0;  ///< connected, of discs that have contacts
  std::int64_t discs_without_contacts = 0;
  std::int64_t free_rigid_motions = 0;  ///< of pieces and of discs without contacts, under the supports
  std::int64_t gear_modes = 0;          ///< groups of discs that can counter-rotate

  [[nodiscard]] bool rigid() const { return free_rigid_motions == 0 && gear_modes == 0; }
};

inline RigidityReport examine_rigidity(const Assembly& assembly, const ContactGraph& graph,
                                       const ContactSprings& springs, const DegreesOfFreedom& unknowns) {
  const FreeMotions motions = find_free_motions(assembly, graph, springs, unknowns);
  RigidityReport report;
  for (const PieceMotions& piece : motions.pieces) {
    ++(piece.has_contacts ? report.pieces : report.discs_without_contacts);
    report.free_rigid_motions += static_cast<std::int64_t>(piece.free.size());
  }
  report.gear_modes = static_cast<std::int64_t>(motions.gears.size());
  return report;
}

}  // namespace equidem
