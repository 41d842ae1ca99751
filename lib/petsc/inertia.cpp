// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/inertia.hpp"

#include <string_view>

namespace equidem::petsc {
namespace {

/// The control parameter of MUMPS for its root: 1 eliminates that without ScaLAPACK.
constexpr PetscInt root_control = 13, root_on_one_rank = 1;

/// Whether the solver is L D L^T by MUMPS.
bool counts(PC preconditioner) {
  PetscBool cholesky = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(preconditioner), PCCHOLESKY, &cholesky));
  if (cholesky == PETSC_FALSE) return false;
  MatSolverType package = nullptr;
  check(PCFactorGetMatSolverType(preconditioner, &package));
  return package != nullptr && std::string_view(package) == MATSOLVERMUMPS;
}

/// Negative pivots of a factor; -1 where it was not made to count.
std::int64_t negative_pivots(const Ranks& ranks, Mat factor) {
#if defined(PETSC_HAVE_MUMPS)
  PetscInt root = 0, negative = 0;
  check(MatMumpsGetIcntl(factor, root_control, &root));
  if (ranks.count() > 1 && root != root_on_one_rank) return -1;
  // MUMPS has refused a pivot of zero; only where it is told to go on beyond those does it count them.
  check(MatGetInertia(factor, &negative, nullptr, nullptr));
  return negative;
#else
  static_cast<void>(ranks), static_cast<void>(factor);
  return -1;
#endif
}

void count_at_root(Mat factor) {
#if defined(PETSC_HAVE_MUMPS)
  check(MatMumpsSetIcntl(factor, root_control, root_on_one_rank));
#else
  static_cast<void>(factor);
#endif
}

/// Negative eigenvalues of the rotations with all translations held.
std::int64_t negative_rotations(const Network& network, Mat stiffness) {
  if (network.block() != 3) return 0;
  PetscInt first = 0, end = 0;
  check(MatGetOwnershipRange(stiffness, &first, &end));
  IS rotations = nullptr;
  check(ISCreateStride(network.ranks().communicator(), (end - first) / 3, first + 2, 3, &rotations));
  Mat matrix = nullptr, factor = nullptr;
  check(MatCreateSubMatrix(stiffness, rotations, rotations, MAT_INITIAL_MATRIX, &matrix));
  check(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  check(MatGetFactor(matrix, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, &factor));
  count_at_root(factor);
  check(MatCholeskyFactorSymbolic(factor, matrix, nullptr, nullptr));
  check(MatCholeskyFactorNumeric(factor, matrix, nullptr));
  MatFactorError failure = MAT_FACTOR_NOERROR;
  check(MatFactorGetError(factor, &failure));
  const std::int64_t negative = failure == MAT_FACTOR_NOERROR ? negative_pivots(network.ranks(), factor) : -1;
  check(MatDestroy(&factor));
  check(MatDestroy(&matrix));
  check(ISDestroy(&rotations));
  return negative;
}

}  // namespace

void prepare_to_count(KSP solver) {
  PC preconditioner = nullptr;
  check(KSPGetPC(solver, &preconditioner));
  if (!counts(preconditioner)) return;
  check(PCFactorSetUpMatSolverType(preconditioner));
  Mat factor = nullptr;
  check(PCFactorGetMatrix(preconditioner, &factor));
  count_at_root(factor);
}

Inertia inertia_of(const Network& network, KSP solver, Mat stiffness) {
  if (!network.any_negative()) return {.negative_pivots = 0, .unstable_modes = 0};
  PC preconditioner = nullptr;
  check(KSPGetPC(solver, &preconditioner));
  if (!counts(preconditioner)) return {};
  Mat factor = nullptr;
  check(PCFactorGetMatrix(preconditioner, &factor));
  const std::int64_t negative = negative_pivots(network.ranks(), factor);
  const std::int64_t of_rotations = negative_rotations(network, stiffness);
  if (negative < 0 || of_rotations < 0) return {.negative_pivots = negative};
  return {.negative_pivots = negative, .unstable_modes = negative - of_rotations};
}

}  // namespace equidem::petsc
