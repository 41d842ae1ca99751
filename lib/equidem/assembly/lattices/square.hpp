// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs on a square grid (Abe 1996, Fig. 4).
#pragma once

#include "equidem/assembly/lattices/lattice.hpp"
#include "equidem/assembly/lattices/row_lattice.hpp"

namespace equidem {

inline RowPattern square_rows(double a) {
  return {.kind = "square", .staggered = false, .row_distance = 2 * a, .cell_area = 4 * a * a, .facet_length = 2 * a};
}

/// Groups as of row_lattice, tributary lengths 2a. The area per disc is 4 a².
/// \throws Error (bad_input) on counts or a radius that make no lattice
inline Assembly square_lattice(const LatticeOptions& options) {
  return row_lattice(options, square_rows(options.radius));
}

namespace lattices {

/// Eq. (31): C11 = kN, C12 = 0, C66 = kT/2, so kN = kT = E and nu = 0. Tension along a row: nu = 0, s11 = kN e11.
inline constexpr Lattice square{
    .name = "square",
    .alignment = RowAlignment::aligned,
    .make = square_lattice,
    .rows = square_rows,
    .relation = {
        .name = "square lattice, eq. (31)",
        .place = "square lattice",
        .source = "Abe 1996, eq. 31",
        .validity = "holds for nu = 0 and kT = kN = E only: the square lattice has C11 = kN, C12 = 0 and C66 = "
                    "kT/2, which is isotropic for kT = kN only, and nu = 0 then (Abe 1996, eq. 31).",
        .static_limit = "the square lattice is unstable for every kT < 0",
        .equal_springs = "the square lattice has C11 = kN, C12 = 0 and C66 = kT/2, which is isotropic for kT = kN "
                         "only, and nu = 0 then",
        .moduli = [](const SpringConstants& k,
                     const IsotropicMeasures&) { return SheetModuli{.bulk = k.kN / 2, .shear = k.kN / 2}; },
        .springs =
            [](const ElasticModuli& moduli, double, const IsotropicMeasures&) {
              const double E = 2 * moduli.shear_modulus;
              return SpringConstants{E, E};
            },
    },
    .tension = [](double) { return TensionTheory{.poisson_ratio = 0, .stiffness_ratio = 1}; },
};

}  // namespace lattices
}  // namespace equidem
