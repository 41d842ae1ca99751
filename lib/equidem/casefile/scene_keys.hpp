// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The keys of what is computed on: the top of the case file, the assembly, its springs and effects.
#pragma once

#include <vector>

#include "equidem/casefile/keys.hpp"

namespace equidem {

std::vector<KeySpec> scene_keys();

}  // namespace equidem
