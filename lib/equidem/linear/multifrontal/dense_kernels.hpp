// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Dense linear algebra on column-major panels; the only place that calls BLAS and LAPACK. Each call runs on one
/// thread: the library divides the work itself, so that results do not depend on the number of threads.
#pragma once

#include <complex>
#include <cstddef>

namespace equidem::dense {

/// Keep BLAS from starting threads of its own; every user of these kernels calls it once.
void use_one_thread_per_call();

/// The following are there for float and double, products and solutions also for std::complex<double>, of which
/// nothing is conjugated.
/// A = L L^T in the lower triangle of the n x n matrix a. Returns 0, or the 1-based index of the first pivot that is
/// not positive.
template <typename Real>
int cholesky(std::size_t n, Real* a, std::size_t lda);
/// B := B L^-T with L the lower triangle n x n, B of m rows.
template <typename Real>
void solve_right_transposed(std::size_t m, std::size_t n, const Real* l, std::size_t ldl, Real* b, std::size_t ldb);
/// Lower triangle of C (n x n) -= A A^T, A of k columns.
template <typename Real>
void subtract_square(std::size_t n, std::size_t k, const Real* a, std::size_t lda, Real* c, std::size_t ldc);
/// C (m x n) -= A B^T, A of m rows and B of n rows, both of k columns.
template <typename Real>
void subtract_product_transposed(std::size_t m, std::size_t n, std::size_t k, const Real* a, std::size_t lda,
                                 const Real* b, std::size_t ldb, Real* c, std::size_t ldc);
/// C (m x n) -= A B with A (m x k), B (k x n).
template <typename Real>
void subtract_product(std::size_t m, std::size_t n, std::size_t k, const Real* a, std::size_t lda, const Real* b,
                      std::size_t ldb, Real* c, std::size_t ldc);
/// C (m x n) -= A^T B with A (k x m), B (k x n).
template <typename Real>
void subtract_transposed_product(std::size_t m, std::size_t n, std::size_t k, const Real* a, std::size_t lda,
                                 const Real* b, std::size_t ldb, Real* c, std::size_t ldc);
/// X := L^-1 X, or L^-T X, for n x columns right-hand sides; `unit`: the diagonal of L is taken as 1.
template <typename Real>
void solve_lower(std::size_t n, std::size_t columns, const Real* l, std::size_t ldl, Real* x, std::size_t ldx,
                 bool unit = false);
template <typename Real>
void solve_lower_transposed(std::size_t n, std::size_t columns, const Real* l, std::size_t ldl, Real* x,
                            std::size_t ldx, bool unit = false);

/// Eigenvalues, ascending, of the symmetric or Hermitian matrix in the lower triangle of a (n x n), which is lost: a
/// holds orthonormal eigenvectors in its columns where `vectors` is set. Returns 0, or a positive number where
/// they do not converge.
int find_spectrum(std::size_t n, double* a, double* values, bool vectors);
int find_spectrum(std::size_t n, std::complex<double>* a, double* values, bool vectors);

}  // namespace equidem::dense
