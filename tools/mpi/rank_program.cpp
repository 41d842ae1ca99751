// SPDX-License-Identifier: GPL-3.0-or-later
#include "rank_program.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <thread>

#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

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

}  // namespace

void silence_other_ranks() {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0) return;
  terminal = dup(STDERR_FILENO);
  for (std::FILE* stream : {stdout, stderr}) static_cast<void>(!std::freopen("/dev/null", "w", stream));
}

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
    return 0;
  };
}

}  // namespace equidem
