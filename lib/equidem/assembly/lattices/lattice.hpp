// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A regular arrangement of equal touching discs, with the theory of its springs.
///
/// A lattice is one file of this folder that defines a constant of type Lattice, and one line of the list in
/// lattices.cpp. The case file, reports, the tension test and calibration take it from the list.
///
/// make() checks columns, rows (periodic: what of them repeats) and the radius (`measurable`). Of the Assembly it fills
/// kind (the name of the lattice), centres, radii, contacts (each once, with both levers), cell_areas, facet_lengths,
/// and the period or, of a free block, the groups that row_lattice.hpp lists; left and right are of equal height. Rows
/// of touching discs, in line or staggered, are made by row_lattice. In a free block leave out discs with one contact:
/// they can roll, and solve reports a mechanism.
#pragma once

#include "equidem/assembly/assembly.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

/// Rows of touching discs, in line or staggered (row_lattice.hpp).
struct RowPattern {
  const char* kind;
  bool staggered;       ///< every other row is shifted by one radius
  double row_distance;  ///< m
  double cell_area;     ///< m², of a disc
  double facet_length;  ///< m, of a contact
};

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
  /// The rows that `make` gives to row_lattice, by the radius: parts of such a lattice can be made without the rest;
  /// null where it is not made by row_lattice.
  RowPattern (*rows)(double radius) = nullptr;

  /// Between equal springs and moduli as the stress shows them; calibrate uses it with rotation restrained, too.
  /// Neither function may be null. `moduli` throws Error (bad_input) where nothing is known: homogenize then leaves the
  /// theory out; springs_for() and calibrate take the range of Poisson's ratios from it. `springs` throws there.
  SpringRelation relation;
  /// With rotation restrained: the relation that fits the equation of the displacements; null where none is known.
  const SpringRelation* restrained = nullptr;
  double critical_ratio = 0;  ///< kT/kN at and below which the infinite lattice is unstable
  /// \param ratio kT/kN
  TensionTheory (*tension)(double ratio) = nullptr;  ///< null where none is known; reports ignore the rotation
};

}  // namespace equidem
