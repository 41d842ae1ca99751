// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/ranks.hpp"

#include <numeric>
#include <optional>

#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem::petsc {

Ranks::Ranks(MPI_Comm communicator) : communicator_(communicator) {
  MPI_Comm_rank(communicator, &rank_);
  MPI_Comm_size(communicator, &count_);
}

void Ranks::sum(std::span<double> numbers) const {
  MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_DOUBLE, MPI_SUM, communicator_);
}

double Ranks::sum(double number) const {
  sum(std::span(&number, 1));
  return number;
}

std::int64_t Ranks::sum(std::int64_t number) const {
  MPI_Allreduce(MPI_IN_PLACE, &number, 1, MPI_INT64_T, MPI_SUM, communicator_);
  return number;
}

double Ranks::largest(double number) const {
  MPI_Allreduce(MPI_IN_PLACE, &number, 1, MPI_DOUBLE, MPI_MAX, communicator_);
  return number;
}

std::vector<std::int64_t> Ranks::joined(std::span<const std::int64_t> numbers) const {
  const int size = static_cast<int>(numbers.size());
  std::vector<int> sizes(static_cast<std::size_t>(count_)), places(sizes.size(), 0);
  MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, communicator_);
  std::exclusive_scan(sizes.begin(), sizes.end(), places.begin(), 0);
  std::vector<std::int64_t> all(static_cast<std::size_t>(places.back() + sizes.back()));
  MPI_Allgatherv(numbers.data(), size, MPI_INT64_T, all.data(), sizes.data(), places.data(), MPI_INT64_T,
                 communicator_);
  return all;
}

void Ranks::together(const std::function<void()>& work) const {
  std::optional<Error> mine;
  try {
    work();
  } catch (const Error& error) {
    mine = error;
  } catch (const std::bad_alloc&) {
    mine = Error(ErrorKind::out_of_memory, "there is too little memory", fmt::format("on rank {}", rank_),
                 "Use fewer discs, or more machines");
  }
  int failed = mine ? rank_ : count_;
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MIN, communicator_);
  if (failed == count_) return;
  const auto told = [&](std::string text) {
    auto size = static_cast<int>(text.size());
    MPI_Bcast(&size, 1, MPI_INT, failed, communicator_);
    text.resize(static_cast<std::size_t>(size));
    MPI_Bcast(text.data(), size, MPI_CHAR, failed, communicator_);
    return text;
  };
  int kind = mine ? static_cast<int>(mine->kind()) : 0;
  MPI_Bcast(&kind, 1, MPI_INT, failed, communicator_);
  const std::string problem = told(mine ? mine->problem() : ""), why = told(mine ? mine->why() : "");
  const std::string remedy = told(mine ? mine->remedy() : ""), where = told(mine ? mine->where() : "");
  throw Error(static_cast<ErrorKind>(kind), problem, why, remedy, where);
}

void Ranks::stop_if_interrupted() const {
  together([] { equidem::stop_if_interrupted(); });
}

namespace {

/// The sentence of PETSc about its last error.
std::string message_of(PetscErrorCode code) {
  const char* general = nullptr;
  char* specific = nullptr;
  PetscErrorMessage(code, &general, &specific);
  std::string text = specific != nullptr && *specific != '\0' ? specific : general != nullptr ? general : "no message";
  for (char& c : text) c = c == '\n' ? ' ' : c;
  while (text.ends_with(' ') || text.ends_with('.')) text.pop_back();
  return text;
}

}  // namespace

void check(PetscErrorCode code) {
  if (code != 0)
    computation_failed("PETSc ended with an error", message_of(code), "Check the options that begin with -equidem_");
}

void check_options(PetscErrorCode code) {
  if (code != 0)
    bad_input("PETSc refuses an option", message_of(code),
              "Correct those that begin with -equidem_, or leave them out");
}

}  // namespace equidem::petsc
