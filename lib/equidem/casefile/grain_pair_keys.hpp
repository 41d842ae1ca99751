// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The keys of [collisions]: how bodies meet, rebound and part.
#pragma once

#include <vector>

#include "equidem/casefile/engine/keys.hpp"

namespace equidem {

/// Of [collisions], [collisions.walls] and [[collisions.pair]].
std::vector<casefile::KeySpec> keys_of_collisions();

}  // namespace equidem
