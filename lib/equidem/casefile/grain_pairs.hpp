// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [collisions]: how bodies and walls meet.
#pragma once

#include <string>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/casefile/grain_case.hpp"

namespace equidem {

/// Gives grains and walls their kinds, and every two kinds their contact.
/// \param root seen by check_and_complete
/// \param groups of each grain
/// \param result with bodies, walls and law; kinds and contacts are set
/// \throws Error (bad_input) with line and key as set_kinds; also: keys that exclude one another, wave speeds with
///         several densities
void read_collisions(const TomlValue& root, const std::vector<std::string>& groups, GrainCase& result);

}  // namespace equidem
