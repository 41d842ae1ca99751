// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The hexagonal lattice: close-packed rows (Abe 1996, Figs. 5 and 6).
#pragma once

#include <numbers>

#include "equidem/assembly/lattices/lattice.hpp"
#include "equidem/assembly/lattices/row_lattice.hpp"

namespace equidem {

inline RowPattern hexagonal_rows(double a) {
  constexpr double sqrt3 = std::numbers::sqrt3;
  return {.kind = "hexagonal",
          .staggered = true,
          .row_distance = sqrt3 * a,
          .cell_area = 2 * sqrt3 * a * a,
          .facet_length = 2 * a / sqrt3};
}

/// Free: rows alternate `columns` and `columns - 1` discs, the first and every other one long, each short row shifted
/// by one radius. Periodic: `columns` discs in each row, `rows` even. The area per disc is 2 sqrt3 a²; the height of a
/// free block is rows * sqrt3 a. Groups as of row_lattice, tributary lengths sqrt3 a on left and right, 2a on bottom
/// and top.
/// \throws Error (bad_input) on counts or a radius that make no lattice, odd `rows` where periodic
inline Assembly hexagonal_lattice(const LatticeOptions& options) {
  return row_lattice(options, hexagonal_rows(options.radius));
}

/// 2G/((1 - nu) kN) = 2 sqrt3 (1 + r)/(3 + r), r = kT/kN: eq. (37).
inline double hexagonal_stiffness_ratio(double ratio) {
  return 2 * std::numbers::sqrt3 * (1 + ratio) / (3 + ratio);
}

namespace lattices {

/// Eq. (53), rotation restrained: K = sqrt3/2 (kN - kT), G = sqrt3/4 (kN + 3 kT). It matches the equation of the
/// displacements, not the stress.
inline constexpr SpringRelation hexagonal_restrained{
    .name = "hexagonal lattice, rotation restrained, eq. (53)",
    .place = "hexagonal lattice with rotation restrained",
    .source = "Abe 1996, eq. 53",
    .validity =
        "holds for nu <= 1/4 (plane strain; 1/3 in plane stress): above, kT < 0, and only a static answer exists. It "
        "matches the equation of the displacements, so wave speeds and problems with prescribed displacements, but not "
        "the stress, which is not symmetric (Abe 1996, eqs. 53 and 55).",
    .static_limit =
        "with rotation restrained the hexagonal lattice is stable for kT/kN > -1/3, which nu = 1/2 in plane "
        "strain reaches",
    .shear_limit = "-1/3",
    .moduli =
        [](const SpringConstants& k, const IsotropicMeasures&) {
          return SheetModuli{.bulk = std::numbers::sqrt3 / 2 * (k.kN - k.kT),
                             .shear = std::numbers::sqrt3 / 4 * (k.kN + 3 * k.kT)};
        },
    .springs =
        [](const ElasticModuli& moduli, double one_minus_4nu, const IsotropicMeasures&) {
          const double unit = std::numbers::sqrt3 / 6 * moduli.bulk_modulus_2d();
          return SpringConstants{unit * (4 + one_minus_4nu), unit * one_minus_4nu};
        },
};

/// Eq. (34): kN = 2/sqrt3 G/(1 - 2 nu), kT/kN = 1 - 4 nu; read the other way K = sqrt3/2 kN, G = sqrt3/4 (kN + kT).
/// Tension: nu of eq. (22), stiffness ratio of eq. (37).
inline constexpr Lattice hexagonal{
    .name = "hexagonal",
    .counts = "free: rows alternate columns and columns - 1 discs; periodic: the number of rows is even",
    .alignment = RowAlignment::staggered,
    .make = hexagonal_lattice,
    .rows = hexagonal_rows,
    .relation = {
        .name = "hexagonal lattice, eq. (34)",
        .place = "hexagonal lattice",
        .source = "Abe 1996, eq. 34",
        .validity = "holds for nu <= 1/4 (plane strain; 1/3 in plane stress): above, kT < 0, and a static answer "
                    "exists down to kT/kN = -1/3 on the periodic lattice, -0.26 with free edges, a dynamic one "
                    "never. Exact for uniform strain (Abe 1996, eq. 34).",
        .static_limit = "the periodic hexagonal lattice is statically stable for kT/kN > -1/3 only, nu < 1/3 in "
                        "plane strain, and one with free edges for kT/kN > -0.26",
        .moduli =
            [](const SpringConstants& k, const IsotropicMeasures&) {
              return SheetModuli{.bulk = std::numbers::sqrt3 / 2 * k.kN,
                                 .shear = std::numbers::sqrt3 / 4 * (k.kN + k.kT)};
            },
        .springs =
            [](const ElasticModuli& moduli, double one_minus_4nu, const IsotropicMeasures&) {
              const double kN = 2 / std::numbers::sqrt3 * moduli.bulk_modulus_2d();
              return SpringConstants{kN, kN * one_minus_4nu};
            },
    },
    .restrained = &hexagonal_restrained,
    .critical_ratio = -1.0 / 3,
    .tension =
        [](double ratio) {
          return TensionTheory{poisson_ratio_of_ratio(ratio), hexagonal_stiffness_ratio(ratio)};
        },
};

}  // namespace lattices
}  // namespace equidem
