// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The terms of the energy ledger of colliding bodies by name, in one place for all files that keep them.
#pragma once

#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

struct GrainEnergyTerm {
  const char* name;
  double GrainLedger::*value;  ///< J (spheres) or J per m of depth
};

inline constexpr GrainEnergyTerm grain_energy_terms[] = {
    {"kinetic", &GrainLedger::kinetic},
    {"elastic_normal", &GrainLedger::elastic_normal},
    {"elastic_tangential", &GrainLedger::elastic_tangential},
    {"elastic_bond", &GrainLedger::elastic_bond},
    {"potential", &GrainLedger::potential},
    {"lost_restitution", &GrainLedger::lost_restitution},
    {"lost_dashpot", &GrainLedger::lost_dashpot},
    {"lost_slip", &GrainLedger::lost_slip},
    {"lost_tangential_dashpot", &GrainLedger::lost_tangential_dashpot},
    {"lost_release", &GrainLedger::lost_release},
    {"lost_bond", &GrainLedger::lost_bond},
    {"work_of_walls", &GrainLedger::work_of_walls},
    {"initial", &GrainLedger::initial},
};
static_assert(sizeof(GrainLedger) == std::size(grain_energy_terms) * sizeof(double),
              "a term of the ledger is not listed");

/// Energies at a moment.
struct GrainEnergySample {
  std::int64_t step = 0;
  double time = 0;  ///< s
  GrainLedger ledger;
};

/// "" for spheres, "_per_m" for discs: the end of the names of columns with masses, forces and energies.
constexpr const char* per_depth(Body body) {
  return body == Body::disc ? "_per_m" : "";
}

/// "kinetic_J", ..., "error_J"; of discs "kinetic_J_per_m".
inline std::vector<std::string> grain_energy_columns(Body body) {
  std::vector<std::string> columns;
  for (const GrainEnergyTerm& term : grain_energy_terms)
    columns.push_back(fmt::format("{}_J{}", term.name, per_depth(body)));
  columns.push_back(fmt::format("error_J{}", per_depth(body)));
  return columns;
}

inline std::vector<double> grain_energy_cells(const GrainLedger& ledger) {
  std::vector<double> cells;
  for (const GrainEnergyTerm& term : grain_energy_terms) cells.push_back(ledger.*term.value);
  cells.push_back(ledger.error());
  return cells;
}

}  // namespace equidem
