// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem-mpi: statics on several processes, by PETSc.
#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <new>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <petscsys.h>
#include <unistd.h>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/output/quantities.hpp"

#include "mpi_texts.hpp"
#include "parallel_verbs.hpp"
#include "petsc/solver.hpp"

namespace equidem {
namespace {

int terminal = STDERR_FILENO;  // of all ranks

/// Whether all ranks come to the end of the verb within some seconds.
bool all_arrive() {
  constexpr double patience = 10;  // s
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibarrier(PETSC_COMM_WORLD, &request);
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    int arrived = 0;
    MPI_Test(&request, &arrived, MPI_STATUS_IGNORE);
    if (arrived != 0) return true;
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > patience) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

[[noreturn]] void end_all(const std::string& sentence, int exit_code) {
  const std::string line = fmt::format("equidem-mpi: {}\n", sentence);
  static_cast<void>(!write(terminal, line.data(), line.size()));
  MPI_Abort(PETSC_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

/// From here on only rank 0 writes to stdout and stderr.
void silence_other_ranks() {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0) return;
  terminal = dup(STDERR_FILENO);
  for (std::FILE* stream : {stdout, stderr}) static_cast<void>(!std::freopen("/dev/null", "w", stream));
}

}  // namespace

Run on_all_ranks(const std::function<void(const petsc::Ranks&)>& verb) {
  return [verb] {
    const petsc::Ranks ranks(PETSC_COMM_WORLD);
    const auto unless_alone = [&](const std::string& sentence, int exit_code) {
      if (!all_arrive()) end_all(sentence, exit_code);
    };
    try {
      verb(ranks);
    } catch (const Error& error) {
      unless_alone(error.what(), error.exit_code());
      throw;
    } catch (const std::bad_alloc&) {
      unless_alone(fmt::format("there is too little memory on rank {}.", ranks.rank()), 1);
      throw;
    } catch (const std::exception& error) {
      unless_alone(fmt::format("this is a defect of equidem: {}. Please report it.", error.what()), 1);
      throw;
    }
    // The others may have failed: they wait in the same barrier.
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibarrier(PETSC_COMM_WORLD, &request);
    MPI_Wait(&request, MPI_STATUS_IGNORE);
  };
}

}  // namespace equidem

namespace {

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
      .footer = equidem_mpi_txt,
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
