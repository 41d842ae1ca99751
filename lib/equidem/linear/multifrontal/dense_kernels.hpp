// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Dense linear algebra on column-major panels; the only place that calls BLAS and LAPACK. Each call runs on one
/// thread, where its user holds a OneThreadPerCall: the library divides the work itself, so that results do not depend
/// on the number of threads.
#pragma once

#include <complex>
#include <cstddef>

namespace equidem::dense {

/// Keeps BLAS from using threads of its own while one exists: several threads of this library call it at once.
/// Afterwards it has the threads that the process gave it.
class OneThreadPerCall {
 public:
  OneThreadPerCall();
  ~OneThreadPerCall();
  OneThreadPerCall(const OneThreadPerCall&) = delete;
  OneThreadPerCall& operator=(const OneThreadPerCall&) = delete;
};

/// A = L L^T in the lower triangle of the n x n matrix a. Returns 0, or the 1-based index of the first pivot that is
/// not positive.
int cholesky(std::size_t n, double* a, std::size_t lda);
/// B := B L^-T with L the lower triangle n x n, B of m rows.
void solve_right_transposed(std::size_t m, std::size_t n, const double* l, std::size_t ldl, double* b, std::size_t ldb);
/// Lower triangle of C (n x n) -= A A^T, A of k columns.
void subtract_square(std::size_t n, std::size_t k, const double* a, std::size_t lda, double* c, std::size_t ldc);
/// C (m x n) -= A B^T, A of m rows and B of n rows, both of k columns.
void subtract_product_transposed(std::size_t m, std::size_t n, std::size_t k, const double* a, std::size_t lda,
                                 const double* b, std::size_t ldb, double* c, std::size_t ldc);
/// C (m x n) -= A B with A (m x k), B (k x n).
void subtract_product(std::size_t m, std::size_t n, std::size_t k, const double* a, std::size_t lda, const double* b,
                      std::size_t ldb, double* c, std::size_t ldc);
/// C (m x n) -= A^T B with A (k x m), B (k x n).
void subtract_transposed_product(std::size_t m, std::size_t n, std::size_t k, const double* a, std::size_t lda,
                                 const double* b, std::size_t ldb, double* c, std::size_t ldc);
/// X := L^-1 X, or L^-T X, for n x columns right-hand sides; `unit`: the diagonal of L is taken as 1.
void solve_lower(std::size_t n, std::size_t columns, const double* l, std::size_t ldl, double* x, std::size_t ldx,
                 bool unit = false);
void solve_lower_transposed(std::size_t n, std::size_t columns, const double* l, std::size_t ldl, double* x,
                            std::size_t ldx, bool unit = false);

/// Eigenvalues, ascending, of the symmetric or Hermitian matrix in the lower triangle of a (n x n), which is lost: a
/// holds orthonormal eigenvectors in its columns where `vectors` is set. Returns 0, or a positive number where
/// they do not converge.
int find_spectrum(std::size_t n, double* a, double* values, bool vectors);
int find_spectrum(std::size_t n, std::complex<double>* a, double* values, bool vectors);

}  // namespace equidem::dense
