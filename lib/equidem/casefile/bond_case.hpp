// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [bonds] and [[bond]]: discs tied by dashpots.
#pragma once

#include <filesystem>
#include <vector>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

struct BondCase {
  std::vector<GrainBond> bonds;  ///< those of the file, then those of the case
  GrainOptions::BondStep step = GrainOptions::BondStep::exact;
};

std::vector<casefile::KeySpec> bond_keys();

/// \param root seen by check_and_complete; the path becomes that which the program opens
/// \throws Error (bad_input) with line and key: grains that are not there, tied to themselves or twice to one another,
///         no dashpot, a
///         file that is no table of bonds
BondCase read_bonds(TomlValue& root, const std::filesystem::path& folder, std::size_t grains);

}  // namespace equidem
