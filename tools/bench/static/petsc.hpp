// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Algebraic multigrid of PETSc and hypre, by the program bench_static_petsc (tools/bench/peers/matrix_petsc.cpp),
/// which is built where CMake finds PETSc and MPI.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace equidem::bench {

struct PetscSolution {
  double set_up = 0, solve = 0;  ///< s
  int iterations = 0;
  double peak_bytes = 0;  ///< of all processes together, the matrix as they read it included
  double cpu = 0;         ///< s, of all processes since their start, the reading included
  std::vector<double> values;
};

/// Whether the program stands beside this one.
bool has_petsc();

/// \param method "petsc-gamg", "petsc-hypre", or "petsc-hypre-rigid"
/// \param processes of MPI
/// \param matrix file of write_matrix_file
/// \param tolerance relative, of the residual that the iterations carry
/// \throws Error (computation_failed) where the program fails
PetscSolution solve_by_petsc(const std::string& method, int processes, const std::filesystem::path& matrix,
                             double tolerance);

}  // namespace equidem::bench
