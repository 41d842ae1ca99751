// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A regular arrangement of equal touching discs, with the theory of its springs.
///
/// A lattice is one file of this folder that defines a constant of type Lattice, and one line of the list in
/// lattices.cpp. The case file, reports, the tension test and calibration take it from the list.
#pragma once

#include "equidem/assembly/assembly.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

/// A block of a lattice. Rows run along x, the first at the bottom.
struct LatticeOptions {
  int columns = 21;       ///< discs in a row, >= 1
  int rows = 21;          ///< >= 1
  double radius = 0.005;  ///< m, > 0
  bool periodic = false;  ///< in both directions
};

/// Theory of the tension test with equal springs, plane strain.
struct TensionTheory {
  double poisson_ratio = 0;    ///< nu = -e22/(e11 - e22)
  double stiffness_ratio = 0;  ///< s11/(kN e11) = 2G/((1 - nu) kN)
};

/// Arrangement of the discs of different rows of a lattice, by which strain gauges are placed.
enum class RowAlignment {
  aligned,    ///< every row has discs at the same x
  staggered,  ///< rows an even number apart have discs at the same x
  irregular,  ///< neither, or discs are not numbered row by row: gauges are the discs nearest to the points wanted
};

struct Lattice {
  const char* name;         ///< the choice of assembly.kind in the case file, and Assembly::kind
  const char* counts = "";  ///< help: conditions on columns and rows; may be empty
  RowAlignment alignment = RowAlignment::irregular;
  /// \throws Error (bad_input) on options that make no such lattice
  Assembly (*make)(const LatticeOptions& options);

  SpringRelation relation;  ///< between equal springs and moduli
  /// With rotation restrained: the relation that fits the equation of the displacements; null where none is known.
  const SpringRelation* restrained = nullptr;
  double critical_ratio = 0;  ///< kT/kN at and below which the infinite lattice is unstable
  /// \param ratio kT/kN
  TensionTheory (*tension)(double ratio) = nullptr;  ///< null where no theory is known
};

}  // namespace equidem
