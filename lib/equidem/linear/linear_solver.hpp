// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The linear solvers and their options.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "equidem/core/names.hpp"
#include "equidem/linear/factorization.hpp"

namespace equidem {

struct DegreesOfFreedom;
struct MatrixOnGraph;
struct SolverOptions;
struct SymbolicFactor;

/// A solver that statics can choose. A back end is one file that defines its `factorize`, and its lines in
/// SolverMethod and the list below.
struct BackEnd {
  bool definite_only = false;  ///< needs a positive definite matrix: refuses kT < 0
  bool iterative = false;      ///< multigrid_solver: no order of elimination, no factor; mechanisms are refused
  double good_enough = 1e-15;  ///< relative residual at which refinement ends
  double memory_factor = 1;    ///< estimated peak memory, over that of the multifrontal factorization
  /// Null: our multifrontal factorizations, which also name mechanisms. Others return null where they meet a zero or
  /// (definite_only) negative pivot; K is then factorized by ours.
  std::unique_ptr<Factorization> (*factorize)(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns,
                                              const SymbolicFactor& symbolic, const SolverOptions& options) = nullptr;
};

std::unique_ptr<Factorization> factorize_by_cholmod(const MatrixOnGraph&, const DegreesOfFreedom&,
                                                    const SymbolicFactor&, const SolverOptions&);
std::unique_ptr<Factorization> factorize_by_umfpack(const MatrixOnGraph&, const DegreesOfFreedom&,
                                                    const SymbolicFactor&, const SolverOptions&);

enum class SolverMethod { automatic, multifrontal, cholmod, umfpack, multigrid };

template <>
struct EnumNames<SolverMethod> {
  struct Entry {
    SolverMethod value;
    const char* name;
    const char* help;
    BackEnd back_end;
  };
  static constexpr const char* what = "solver method";
  static constexpr Entry list[] = {
      {SolverMethod::automatic,
       "auto",
       "multigrid from 20000 discs on with kT >= 0, but for slender assemblies; else multifrontal",
       {}},
      {SolverMethod::multifrontal, "multifrontal", "ours: Cholesky where no spring is negative, else L D L^T", {}},
      {SolverMethod::cholmod,
       "cholmod",
       "SuiteSparse's CHOLMOD, supernodal Cholesky in the order of the key ordering",
       {.definite_only = true, .factorize = factorize_by_cholmod}},
      {SolverMethod::umfpack,
       "umfpack",
       "SuiteSparse's unsymmetric LU in its own order",
       {.memory_factor = 2.6, .factorize = factorize_by_umfpack}},
      {SolverMethod::multigrid,
       "multigrid",
       "conjugate gradients with a multigrid cycle, for large assemblies with kT >= 0",
       {.definite_only = true, .iterative = true, .good_enough = 1e-12}},
  };
};

/// Order in which CHOLMOD eliminates the unknowns.
enum class CholmodOrdering { equidem, metis, amd };

template <>
struct EnumNames<CholmodOrdering> {
  struct Entry {
    CholmodOrdering value;
    const char* name;
    const char* help;
    const char* in_reports;
    double memory_factor;  ///< estimated peak memory over that in our order (data/benchmarks/statics.md)
  };
  static constexpr const char* what = "ordering";
  static constexpr Entry list[] = {
      {CholmodOrdering::equidem, "equidem", "our nested dissection of the discs", "the order of equidem", 1},
      {CholmodOrdering::metis, "metis", "CHOLMOD's METIS, nested dissection of the unknowns", "METIS order", 1},
      {CholmodOrdering::amd, "amd", "CHOLMOD's AMD, approximate minimum degree", "AMD order", 1.3},
  };
};

/// Estimated peak memory of a factorization over that of the multifrontal one.
inline double memory_factor(SolverMethod method, CholmodOrdering ordering) {
  return entry_of(method).back_end.memory_factor * entry_of(ordering).memory_factor;
}

/// Iterations after which an iterative method gives up, >= 1.
inline constexpr int most_iterations = 250;

struct SolverOptions {
  SolverMethod method = SolverMethod::automatic;
  CholmodOrdering ordering = CholmodOrdering::equidem;  ///< for SolverMethod::cholmod alone
  int max_refinements = 4;                              ///< steps of iterative refinement, >= 0
  double memory_limit = 0;  ///< bytes that factor and factorization may take; 0: what the machine has free
  /// Wanted of the motions, relative, in the norm of energy; iterative methods end there, others ignore it. 0:
  /// round-off.
  double accuracy = 0;
  int right_hand_sides = 1;  ///< that will be solved for, about: "auto" depends on it
};

/// \throws Error (bad_input) on a negative number of refinements, a memory limit that is negative or no number, or an
///         ordering of CHOLMOD beside another method
void check(const SolverOptions& options);

}  // namespace equidem
