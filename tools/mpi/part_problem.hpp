// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case made ready to be solved by several ranks.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"
#include "petsc/statics.hpp"
#include "problem.hpp"

namespace equidem {

/// The case on one rank. Parts refer to one another: it does not move.
struct PartProblem {
  explicit PartProblem(Case resolved);
  PartProblem(const PartProblem&) = delete;
  PartProblem& operator=(const PartProblem&) = delete;

  Problem problem;  ///< its assembly is empty
  petsc::Part part;
  petsc::Whole whole;
  Effects effects;
  std::optional<RowLattice> lattice;  ///< of which the part is a block
  bool scattered = false;             ///< rank 0 has read or packed the whole assembly
  Results of_problem;                 ///< of a scattered assembly, on rank 0
  std::vector<std::int64_t> held;     ///< of homogenize: components that stop free motions, as Network::hold
  std::int64_t gears = 0, removed = 0, rattlers = 0;  ///< of homogenize of a scattered assembly
  std::vector<std::string> left_out;                  ///< likewise: sentences
};

/// Makes the part of this rank: of a lattice a block, of a triangulation a strip; an assembly that is read or packed
/// comes from rank 0.
/// \throws Error on all ranks
std::unique_ptr<PartProblem> build_part_problem(const petsc::Ranks& ranks, const CommonOptions& options,
                                                bool homogenize);

/// Title, assembly, springs, effects; all ranks call it.
Results part_problem_results(const petsc::Ranks& ranks, const PartProblem& problem);

}  // namespace equidem
