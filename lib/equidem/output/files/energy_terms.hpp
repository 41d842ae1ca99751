// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The terms of the energy ledger by name, in one place for all files that keep them, and how they change with time.
#pragma once

#include <cstdint>
#include <iterator>

#include "equidem/dynamics/simulation.hpp"

namespace equidem {

struct EnergyTerm {
  const char* name;
  double EnergyLedger::*value;  ///< J per m of depth
};

inline constexpr EnergyTerm energy_terms[] = {
    {"kinetic", &EnergyLedger::kinetic},
    {"elastic", &EnergyLedger::elastic},
    {"potential", &EnergyLedger::potential},
    {"sway", &EnergyLedger::sway},
    {"damped_mass", &EnergyLedger::damped_mass},
    {"damped_contact", &EnergyLedger::damped_contact},
    {"damped_local", &EnergyLedger::damped_local},
    {"work_of_loads", &EnergyLedger::work_of_loads},
    {"work_of_supports", &EnergyLedger::work_of_supports},
    {"work_of_walls", &EnergyLedger::work_of_walls},
    {"initial", &EnergyLedger::initial},
};
static_assert(sizeof(EnergyLedger) == std::size(energy_terms) * sizeof(double), "a term of the ledger is not listed");

/// Energies at a moment.
struct EnergySample {
  std::int64_t step = 0;
  double time = 0;  ///< s
  EnergyLedger ledger;
};

}  // namespace equidem
