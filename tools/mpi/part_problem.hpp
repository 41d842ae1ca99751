// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case made ready to be solved by several ranks, what their reports share, and the files of each.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "command.hpp"
#include "petsc/equilibrium.hpp"
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

/// An assembly that rank 0 reads or packs, with the checks of the serial verb on the whole of it.
/// \throws Error on all ranks
void scatter_problem(const petsc::Ranks& ranks, PartProblem& problem, bool homogenize);

/// Title, assembly, springs, effects; all ranks call it.
Results part_problem_results(const petsc::Ranks& ranks, const PartProblem& problem);
/// The ranks: their number, discs, memory, messages of an exchange and in all.
Results rank_results(const petsc::Ranks& ranks, const petsc::Network& network, const petsc::Counted& before,
                     const petsc::Counted& after);

/// Whether every disc that the rank owns has a cell of some area.
bool cells_are_known(const petsc::Part& part);

/// \throws Error (bad_input) where a file of any rank could not be written
void expect_part_files(const OutputPlan& plan, const petsc::Ranks& ranks, const std::string& name);

/// NAME_discs_K.vtp and NAME_contacts_K.vtp of rank K, by rank 0 also NAME.vtm.
/// \param motions per disc of the part
void write_part_files(const std::filesystem::path& folder, const std::string& name, const petsc::Ranks& ranks,
                      const petsc::Part& part, std::span<const DiscMotion> motions,
                      std::span<const ContactForce> forces, bool overwrite);

}  // namespace equidem
