// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Places of contacts relative to one another.
#pragma once

#include <array>
#include <cstddef>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// Whether the points of three contacts, of which each shares a disc with the next, lie in line: the sine of the angle
/// between the two chords is at most 1e-6.
bool points_in_line(const Assembly& assembly, const std::array<std::size_t, 3>& contacts);

}  // namespace equidem
