// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One measured solution of a problem by one solver: a plate of discs, its left side held, its right side pulled.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace equidem::bench {

struct Solver {
  std::string name;     ///< on the command line
  std::string label;    ///< in tables
  std::string threads;  ///< meaning of a number of threads
};
const std::vector<Solver>& solvers();

struct Trial {
  std::string solver;
  std::string kind;  ///< of the assembly, one of assembly_kinds()
  std::int64_t discs = 0;
  int threads = 1;
};

/// Times in seconds.
struct Measurement {
  double discs = 0;
  double unknowns = 0;
  double assembly = 0;  ///< K as blocks on the graph of discs; not part of the total
  double convert = 0;   ///< K into the columns that the solver takes; not part of the total
  double order = 0;
  double analyze = 0;
  double factorize = 0;
  double solve = 0;
  double iterations = 0;    ///< 0: a direct solver
  double nonzeros = 0;      ///< entries of L, lower triangle, without explicit zeros
  double factor_bytes = 0;  ///< stored of L
  double residual = 0;      ///< |f - K u| / |f|, 2-norms, without refinement
  double peak_bytes = 0;    ///< of the process
  double cpu = 0;           ///< of all threads of the process since its start

  [[nodiscard]] double total() const { return order + analyze + factorize + solve; }
  [[nodiscard]] double stored_over_nonzeros() const { return factor_bytes / sizeof(double) / nonzeros; }
  [[nodiscard]] double peak_over_factor() const { return peak_bytes / factor_bytes; }
};

/// Solve the problem once, in this process.
/// \throws Error (computation_failed) where the matrix is not positive definite
Measurement measure(const Trial& trial);

/// Write the stiffness matrix of a problem to a file, for solvers of other programs. Little-endian: four int64
/// (unknowns n, entries, components of a disc, 0); n + 1 and `entries` int32, the lower triangle in compressed columns;
/// then doubles: its values; the load (n); x and y of the disc of each unknown over the scale of rotations (2 n); then
/// n int32: component (0, 1, 2) of each unknown. \throws Error (bad_input) where the file cannot be written
void write_matrix_file(const std::string& path, const std::string& kind, std::int64_t discs);

}  // namespace equidem::bench
