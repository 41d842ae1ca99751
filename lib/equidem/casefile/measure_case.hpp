// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [measures]: what is read off bodies in a box while they move.
#pragma once

#include <vector>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/fields/box_measures.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// The keys of [measures].
std::vector<casefile::KeySpec> measure_keys();

/// \param table [measures], seen by check_and_complete
/// \throws Error (bad_input) with line and key: a region without area, spheres
MeasureOptions read_measures(const TomlValue& table, Body body);

}  // namespace equidem
