// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// All lattices.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "equidem/assembly/lattices/hexagonal.hpp"
#include "equidem/assembly/lattices/lattice.hpp"
#include "equidem/assembly/lattices/square.hpp"

namespace equidem {

/// All lattices, in the order of the choices of the case file.
std::span<const Lattice> all_lattices();

/// The lattice with this name; null where there is none. With Assembly::kind: the lattice of an assembly.
const Lattice* find_lattice(std::string_view name);

/// Conditions on columns and rows of all lattices, for the help of the case file.
std::string lattice_counts();

}  // namespace equidem
