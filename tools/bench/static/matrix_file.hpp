// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The stiffness matrix of a problem as a file, for solvers that live in other programs.
#pragma once

#include <cstdint>
#include <string>

namespace equidem::bench {

/// Little-endian: four int64 (unknowns n, entries, components of a disc, 0); n + 1 and `entries` int32, the lower
/// triangle in compressed columns; then doubles: its values; the load (n); x and y of the disc of each unknown over the
/// scale of rotations (2 n); then n int32: which component (0, 1, 2) an unknown is.
/// \throws Error (bad_input) where the file cannot be written
void write_matrix_file(const std::string& path, const std::string& kind, std::int64_t discs);

}  // namespace equidem::bench
