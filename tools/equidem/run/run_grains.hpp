// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// `equidem run` of bodies that collide.
#pragma once

#include "command.hpp"

namespace equidem {

/// \param resume go on from the checkpoint in --out
/// \return the exit code
int run_grains(const CommonOptions& common, bool resume);

}  // namespace equidem
