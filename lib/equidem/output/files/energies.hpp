// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The energy ledger as columns of tables and as a JSON object.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "equidem/material/inertia.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

/// "" for spheres, "_per_m" for discs: the end of the names of columns with masses, forces and energies.
constexpr const char* per_depth(Body body) {
  return body == Body::disc ? "_per_m" : "";
}

/// "kinetic_J", ..., "error_J"; of discs "kinetic_J_per_m".
std::vector<std::string> energy_columns(BodyFamily family, Body body);
std::vector<double> energy_cells(BodyFamily family, const EnergyLedger& ledger);

/// One row per moment: step, time_s, energy_columns.
/// \throws Error (bad_input) as write_file does
void write_energy_csv(const std::filesystem::path& path, std::span<const EnergySample> energies, BodyFamily family,
                      Body body, bool overwrite);

/// Every term of the ledger, then elastic, dissipated, input, error, and relative_error, the error over `scale`.
Results energy_results(BodyFamily family, Body body, const EnergyLedger& ledger, double scale);

}  // namespace equidem
