// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The hexagonal lattice by another name.
#pragma once

#include "equidem/assembly/lattices/hexagonal.hpp"

namespace equidem {

inline Assembly triangular_lattice(const LatticeOptions& options) {
  Assembly assembly = hexagonal_lattice(options);
  assembly.kind = "triangular";
  return assembly;
}

namespace lattices {

inline constexpr Lattice triangular{
    .name = "triangular",
    .counts = hexagonal.counts,
    .alignment = RowAlignment::staggered,
    .make = triangular_lattice,
    .relation = hexagonal.relation,
    .critical_ratio = hexagonal.critical_ratio,
    .tension = hexagonal.tension,
};

}  // namespace lattices
}  // namespace equidem
