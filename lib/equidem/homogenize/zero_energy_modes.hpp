// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Zero-energy modes that leave the effective stiffness unchanged, and those that do not.
#pragma once

#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/statics/hold_free_motions.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

/// A motion without energy that leaves the effective stiffness unchanged.
struct ZeroEnergyMode {
  std::string kind;         ///< "gear", "local"
  std::string description;  ///< which discs, which motion
};

/// Gears, and mechanisms of a few discs: no contact is deformed by them, so that the forces of any mean strain do no
/// work on them. At most eight of each kind are described.
/// \param name of the network for messages: "the network", "the cell, cut open at its boundary,"
/// \throws Error (bad_input) where a mechanism runs through the sample (winds around the period, or moves a quarter of
///         the discs of a free sample), or where there are more than 1000: the network is floppy
std::vector<ZeroEnergyMode> zero_energy_modes(const Assembly& assembly, const StiffnessSolver& solver,
                                              const HeldMotions& held, const std::string& name);

}  // namespace equidem
