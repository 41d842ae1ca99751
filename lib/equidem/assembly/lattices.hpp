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

/// The lattice with this name; null where there is none.
const Lattice* find_lattice(std::string_view name);

/// The lattice of an assembly: the one that it was made as (Assembly::kind), or the one whose `make` gives its centres
/// (to 1e-9 of a radius), radii and sides in this order, as a file or arrays may hold it; null where there is none.
const Lattice* lattice_of(const Assembly& assembly);

/// Conditions on columns and rows of all lattices, for the help of the case file.
std::string lattice_counts();

}  // namespace equidem
