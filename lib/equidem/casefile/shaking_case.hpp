// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [shaking]: the motion of a box.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/grains/scene/shaking.hpp"

namespace equidem {

/// The keys of [shaking] and wall.shaken.
std::vector<casefile::KeySpec> shaking_keys();

/// Read [shaking] and let the walls move so, but for those with shaken = false.
/// \param root seen by check_and_complete, with [shaking]; the path of the record becomes that which the program opens
/// \param walls in the order of [[wall]]
/// \param run_duration s: as long the box shakes where nothing else is said
/// \throws Error (bad_input) with line and key: no motion or two, a duration of no whole cycles, no wall that moves, a
///         wall that moves by
///         itself as well, a record that is no table
Shaking read_shaking(TomlValue& root, const std::filesystem::path& folder, double run_duration,
                     std::span<Wall> walls);

}  // namespace equidem
