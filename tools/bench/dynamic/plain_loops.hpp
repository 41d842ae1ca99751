// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The two loops that people write, plainly: springs with rotation, leapfrog, small motions.
#pragma once

#include <memory>

#include "equidem/assembly/assembly.hpp"

#include "contender.hpp"

namespace equidem::bench {

/// Every disc sums the forces of its own contacts, each contact being computed twice.
std::unique_ptr<Contender> plain_loop_over_neighbours(const Assembly& assembly);

/// Every contact once, its force added to both discs; then all discs move.
std::unique_ptr<Contender> plain_loop_over_pairs(const Assembly& assembly);

}  // namespace equidem::bench
