// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The keys of what is computed, and how: tests, supports and loads, homogenization, solver, output.
#pragma once

#include <vector>

#include "equidem/casefile/keys.hpp"

namespace equidem {

std::vector<KeySpec> task_keys();

}  // namespace equidem
