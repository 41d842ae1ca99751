// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The keys of motion in time: the run, schedules, walls, velocities, probes, and when output is written.
#pragma once

#include <vector>

#include "equidem/casefile/keys.hpp"

namespace equidem {

std::vector<KeySpec> run_keys();

}  // namespace equidem
