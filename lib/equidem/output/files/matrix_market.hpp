// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Matrices as texts in the Matrix Market format (Boisvert, Pozo & Remington 1996), which SciPy, MATLAB, Julia and
/// PETSc read. Numbers read back to the same bits.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

/// Returns the bytes of the file of a symmetric matrix, about.
double bytes_of_text(const CompressedColumns& lower);

/// A symmetric matrix by its lower triangle: "coordinate real symmetric".
/// \param comment lines that the file begins with
/// \throws Error (computation_failed) where memory would not suffice for the text
std::string matrix_market(const CompressedColumns& lower, const std::string& comment);

/// Columns of equal length as a dense matrix: "array real general".
/// \throws Error as above
std::string matrix_market(std::span<const std::vector<double>> columns, const std::string& comment);

}  // namespace equidem
