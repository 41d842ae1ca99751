// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/dense_kernels.hpp"

#include <mutex>
#include <vector>

#include <cblas.h>

extern "C" {
void dpotrf_(const char* triangle, const int* n, double* a, const int* lda, int* info);
void dsyevd_(const char* job, const char* triangle, const int* n, double* a, const int* lda, double* values,
             double* work, const int* work_size, int* iwork, const int* iwork_size, int* info);
void zheevd_(const char* job, const char* triangle, const int* n, std::complex<double>* a, const int* lda,
             double* values, std::complex<double>* work, const int* work_size, double* rwork, const int* rwork_size,
             int* iwork, const int* iwork_size, int* info);
}

namespace equidem::dense {
namespace {

std::mutex threads_mutex;
int users = 0, threads_before = 1;  // of OneThreadPerCall

int as_int(std::size_t n) {
  return static_cast<int>(n);
}
struct Shape {
  std::size_t m, n, k;
};

/// C (m x n) -= op(A) B.
void subtract_product_of(CBLAS_TRANSPOSE op, Shape shape, const double* a, std::size_t lda, const double* b,
                         std::size_t ldb, double* c, std::size_t ldc) {
  const auto [m, n, k] = shape;
  if (m == 0 || n == 0 || k == 0) return;
  if (n == 1) {
    const std::size_t rows = op == CblasNoTrans ? m : k, columns = op == CblasNoTrans ? k : m;
    cblas_dgemv(CblasColMajor, op, as_int(rows), as_int(columns), -1, a, as_int(lda), b, 1, 1, c, 1);
    return;
  }
  cblas_dgemm(CblasColMajor, op, CblasNoTrans, as_int(m), as_int(n), as_int(k), -1, a, as_int(lda), b, as_int(ldb), 1,
              c, as_int(ldc));
}

/// X := op(L)^-1 X.
void solve_triangular(CBLAS_TRANSPOSE op, std::size_t n, std::size_t columns, const double* l, std::size_t ldl,
                      double* x, std::size_t ldx, bool unit) {
  if (n == 0 || columns == 0) return;
  const CBLAS_DIAG diagonal = unit ? CblasUnit : CblasNonUnit;
  if (columns == 1) {
    cblas_dtrsv(CblasColMajor, CblasLower, op, diagonal, as_int(n), l, as_int(ldl), x, 1);
  } else {
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, op, diagonal, as_int(n), as_int(columns), 1, l, as_int(ldl), x,
                as_int(ldx));
  }
}

}  // namespace

OneThreadPerCall::OneThreadPerCall() {
  const std::lock_guard lock(threads_mutex);
  if (users++ > 0) return;
  threads_before = openblas_get_num_threads();
  openblas_set_num_threads(1);
}

OneThreadPerCall::~OneThreadPerCall() {
  const std::lock_guard lock(threads_mutex);
  if (--users == 0) openblas_set_num_threads(threads_before);
}

int cholesky(std::size_t n, double* a, std::size_t lda) {
  const int size = as_int(n), leading = as_int(lda);
  int info = 0;
  dpotrf_("L", &size, a, &leading, &info);
  return info;
}

void solve_right_transposed(std::size_t m, std::size_t n, const double* l, std::size_t ldl, double* b,
                            std::size_t ldb) {
  if (m == 0 || n == 0) return;
  cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, as_int(m), as_int(n), 1, l, as_int(ldl),
              b, as_int(ldb));
}

void subtract_square(std::size_t n, std::size_t k, const double* a, std::size_t lda, double* c, std::size_t ldc) {
  if (n == 0 || k == 0) return;
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, as_int(n), as_int(k), -1, a, as_int(lda), 1, c, as_int(ldc));
}

void subtract_product_transposed(std::size_t m, std::size_t n, std::size_t k, const double* a, std::size_t lda,
                                 const double* b, std::size_t ldb, double* c, std::size_t ldc) {
  if (m == 0 || n == 0 || k == 0) return;
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, as_int(m), as_int(n), as_int(k), -1, a, as_int(lda), b,
              as_int(ldb), 1, c, as_int(ldc));
}

void subtract_product(std::size_t m, std::size_t n, std::size_t k, const double* a, std::size_t lda, const double* b,
                      std::size_t ldb, double* c, std::size_t ldc) {
  subtract_product_of(CblasNoTrans, {m, n, k}, a, lda, b, ldb, c, ldc);
}

void subtract_transposed_product(std::size_t m, std::size_t n, std::size_t k, const double* a, std::size_t lda,
                                 const double* b, std::size_t ldb, double* c, std::size_t ldc) {
  subtract_product_of(CblasTrans, {m, n, k}, a, lda, b, ldb, c, ldc);
}

void solve_lower(std::size_t n, std::size_t columns, const double* l, std::size_t ldl, double* x, std::size_t ldx,
                 bool unit) {
  solve_triangular(CblasNoTrans, n, columns, l, ldl, x, ldx, unit);
}

void solve_lower_transposed(std::size_t n, std::size_t columns, const double* l, std::size_t ldl, double* x,
                            std::size_t ldx, bool unit) {
  solve_triangular(CblasTrans, n, columns, l, ldl, x, ldx, unit);
}

// Divide and conquer; sizes of work arrays by LAPACK's documentation.
int find_spectrum(std::size_t n, double* a, double* values, bool vectors) {
  if (n == 0) return 0;
  const int size = as_int(n), work_size = vectors ? 1 + 6 * size + 2 * size * size : 2 * size + 1;
  const int iwork_size = vectors ? 3 + 5 * size : 1;
  std::vector<double> work(static_cast<std::size_t>(work_size));
  std::vector<int> iwork(static_cast<std::size_t>(iwork_size));
  int info = 0;
  dsyevd_(vectors ? "V" : "N", "L", &size, a, &size, values, work.data(), &work_size, iwork.data(), &iwork_size, &info);
  return info;
}

int find_spectrum(std::size_t n, std::complex<double>* a, double* values, bool vectors) {
  if (n == 0) return 0;
  const int size = as_int(n), work_size = vectors ? 2 * size + size * size : size + 1;
  const int rwork_size = vectors ? 1 + 5 * size + 2 * size * size : size, iwork_size = vectors ? 3 + 5 * size : 1;
  std::vector<std::complex<double>> work(static_cast<std::size_t>(work_size));
  std::vector<double> rwork(static_cast<std::size_t>(rwork_size));
  std::vector<int> iwork(static_cast<std::size_t>(iwork_size));
  int info = 0;
  zheevd_(vectors ? "V" : "N", "L", &size, a, &size, values, work.data(), &work_size, rwork.data(), &rwork_size,
          iwork.data(), &iwork_size, &info);
  return info;
}

}  // namespace equidem::dense
