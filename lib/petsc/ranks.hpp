// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The processes ("ranks") of a parallel program: sums over them, errors that all of them throw.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <petscsys.h>

namespace equidem::petsc {

/// All members that communicate are called by all ranks, in the same order.
class Ranks {
 public:
  explicit Ranks(MPI_Comm communicator);

  [[nodiscard]] MPI_Comm communicator() const { return communicator_; }
  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool first() const { return rank_ == 0; }

  /// Each number becomes its sum over the ranks, in an order that depends on their count alone.
  void sum(std::span<double> numbers) const;
  [[nodiscard]] double sum(double number) const;
  [[nodiscard]] std::int64_t sum(std::int64_t number) const;
  [[nodiscard]] double largest(double number) const;
  [[nodiscard]] double smallest(double number) const { return -largest(-number); }
  [[nodiscard]] bool any(bool holds) const { return largest(holds ? 1 : 0) > 0; }
  /// The numbers of all ranks, one after another.
  [[nodiscard]] std::vector<std::int64_t> joined(std::span<const std::int64_t> numbers) const;

  /// Calls work, which does not communicate. Where it throws an Error on some ranks, all throw that of the lowest of
  /// them.
  void together(const std::function<void()>& work) const;
  /// \throws Error of kind interrupted on all ranks where one of them was asked to stop
  void stop_if_interrupted() const;

 private:
  MPI_Comm communicator_;
  int rank_ = 0, count_ = 1;
};

/// \throws Error (computation_failed) with the message of PETSc where its code is one of an error
void check(PetscErrorCode code);
/// The same for calls in which options of the user decide.
/// \throws Error (bad_input)
void check_options(PetscErrorCode code);

}  // namespace equidem::petsc
