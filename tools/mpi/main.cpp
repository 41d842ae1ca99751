// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem-mpi: statics on several processes, by PETSc.
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <petscsys.h>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/output/quantities.hpp"

#include "petsc/solver.hpp"
#include "rank_program.hpp"

namespace {

constexpr const char* footer = R"(Examples:
  mpirun -n 2 equidem-mpi solve data/cases/abe1996_fig6.toml
  mpirun -n 4 equidem-mpi solve block.toml --out result -equidem_ksp_monitor
  mpirun -n 4 equidem-mpi homogenize cell.toml -equidem_pc_type hypre
  mpirun -n 2 equidem-mpi solve block.toml --set solver.method=multifrontal      by MUMPS

Words that begin with one dash are options of PETSc, with the words that follow them. -equidem_ begins the names of
those of the solver (-equidem_ksp_rtol, -equidem_pc_type, ...); -log_view measures. Options that PETSc does not use are
named at the end.

Exit codes: 0 done; 1 the computation failed, and the message says why; 2 bad input or usage; 130 interrupted. Where a
rank dies, mpirun says so and ends the others, and its exit code is not 0.)";

/// The words of the command line for equidem and for PETSc: a word with one dash and a letter begins an option of
/// PETSc, one with two dashes an option of equidem; others belong to the option before them.
struct Words {
  std::vector<char*> own, of_petsc;
};
Words divided(int argc, char** argv) {
  Words words{{argv[0]}, {argv[0]}};
  bool petsc = false;
  for (int k = 1; k < argc; ++k) {
    const std::string_view word = argv[k];
    if (word.starts_with("--")) {
      petsc = false;
    } else if (word.size() > 2 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])) != 0) {
      petsc = true;
    }
    (petsc ? words.of_petsc : words.own).push_back(argv[k]);
  }
  for (auto* list : {&words.own, &words.of_petsc}) list->push_back(nullptr);
  return words;
}

/// Help is printed without MPI: installers ask for manual pages where none can be started.
bool asks_for_help(int argc, char** argv) {
  constexpr std::string_view words[] = {"help", "--help", "--version"};
  return argc > 1 && std::ranges::find(words, argv[1]) != std::end(words);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace equidem;
  const dense::OneThreadPerCall one_thread;  // beside the other ranks
  return_freed_memory();
  set_thread_count(1);
  Words words = divided(argc, argv);
  const bool parallel = !asks_for_help(argc, argv);
  if (parallel) {
    int count = static_cast<int>(words.of_petsc.size()) - 1;
    char** list = words.of_petsc.data();
    if (PetscInitialize(&count, &list, nullptr, nullptr) != 0) return 1;
    PetscPopSignalHandler();
    PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
    silence_other_ranks();
  }
  const Program program{
      .name = "equidem-mpi",
      .description = "equidem-mpi: equilibrium and moduli of large assemblies of discs, on several processes by PETSc",
      .noun = "verb",
      .usage = "VERB CASE.toml [OPTIONS] [OPTIONS OF PETSC]",
      .footer = footer,
      .verbs = parallel_verbs,
      .topics = {{"case", "the keys of case files of equidem", describe_case_file, case_file_page, describe_case_table},
                 {"result", "the numbers of result.json of equidem, their units and meanings", describe_result}},
      .refusals = {{"--accuracy", "equidem-mpi takes no --accuracy", "each solution has the digits of a double",
                    "Leave it out"}}};
  int result = run_program(program, static_cast<int>(words.own.size()) - 1, words.own.data());
  if (parallel) {
    const std::vector<std::string> unused = petsc::unused_options();
    if (!unused.empty()) {
      std::fprintf(stderr, "equidem-mpi: PETSc did not use %s: there is no such option, or not with this solver.\n",
                   joined(unused).c_str());
    }
    PetscFinalize();
  }
  return result;
}
