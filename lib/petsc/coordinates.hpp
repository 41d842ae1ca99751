// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The entries of K that the contacts of a rank bring, as lists of row, column and value (COO).
#pragma once

#include <cstddef>
#include <vector>

#include <petscmat.h>

#include "petsc/network.hpp"

namespace equidem::petsc {

/// Blocks in the order: on the diagonal of each owned disc; for every contact those of (i, j) and (j, i) and, where j
/// is a ghost, of (j, j). Entries of rows of other ranks are sent there by PETSc and added. Rows and columns of held
/// components are those of the unit matrix times the stiffest spring.
struct Coordinates {
  std::vector<PetscInt> rows, columns;
  std::vector<double> values;

  /// Rows and columns alone.
  explicit Coordinates(const Network& network);
  /// The values.
  void fill(const Network& network);
};

}  // namespace equidem::petsc
