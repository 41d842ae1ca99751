// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/dense_kernels.hpp"

#include <type_traits>
#include <vector>

#include <cblas.h>

extern "C" {
void dpotrf_(const char* triangle, const int* n, double* a, const int* lda, int* info);
void spotrf_(const char* triangle, const int* n, float* a, const int* lda, int* info);
void dsyevd_(const char* job, const char* triangle, const int* n, double* a, const int* lda, double* values,
             double* work, const int* work_size, int* iwork, const int* iwork_size, int* info);
void zheevd_(const char* job, const char* triangle, const int* n, std::complex<double>* a, const int* lda,
             double* values, std::complex<double>* work, const int* work_size, double* rwork, const int* rwork_size,
             int* iwork, const int* iwork_size, int* info);
}

namespace equidem::dense {
namespace {

/// Routines of BLAS and LAPACK for one type of number.
template <typename Real>
struct Blas;

template <>
struct Blas<double> {
  static constexpr auto gemm = cblas_dgemm;
  static constexpr auto gemv = cblas_dgemv;
  static constexpr auto syrk = cblas_dsyrk;
  static constexpr auto trsm = cblas_dtrsm;
  static constexpr auto trsv = cblas_dtrsv;
  static constexpr auto potrf = dpotrf_;
};

template <>
struct Blas<float> {
  static constexpr auto gemm = cblas_sgemm;
  static constexpr auto gemv = cblas_sgemv;
  static constexpr auto syrk = cblas_ssyrk;
  static constexpr auto trsm = cblas_strsm;
  static constexpr auto trsv = cblas_strsv;
  static constexpr auto potrf = spotrf_;
};

/// CBLAS takes complex factors by address.
template <>
struct Blas<std::complex<double>> {
  using Number = std::complex<double>;
  static void gemm(CBLAS_ORDER order, CBLAS_TRANSPOSE op_a, CBLAS_TRANSPOSE op_b, int m, int n, int k, Number alpha,
                   const Number* a, int lda, const Number* b, int ldb, Number beta, Number* c, int ldc) {
    cblas_zgemm(order, op_a, op_b, m, n, k, &alpha, a, lda, b, ldb, &beta, c, ldc);
  }
  static void syrk(CBLAS_ORDER order, CBLAS_UPLO triangle, CBLAS_TRANSPOSE op, int n, int k, Number alpha,
                   const Number* a, int lda, Number beta, Number* c, int ldc) {
    cblas_zsyrk(order, triangle, op, n, k, &alpha, a, lda, &beta, c, ldc);
  }
  static void trsm(CBLAS_ORDER order, CBLAS_SIDE side, CBLAS_UPLO triangle, CBLAS_TRANSPOSE op, CBLAS_DIAG diagonal,
                   int m, int n, Number alpha, const Number* a, int lda, Number* b, int ldb) {
    cblas_ztrsm(order, side, triangle, op, diagonal, m, n, &alpha, a, lda, b, ldb);
  }
  static constexpr auto trsv = cblas_ztrsv;
};

int as_int(std::size_t n) {
  return static_cast<int>(n);
}
struct Shape {
  std::size_t m, n, k;
};

/// C (m x n) -= op(A) B.
template <typename Real>
void subtract_product_of(CBLAS_TRANSPOSE op, Shape shape, const Real* a, std::size_t lda, const Real* b,
                         std::size_t ldb, Real* c, std::size_t ldc) {
  const auto [m, n, k] = shape;
  if (m == 0 || n == 0 || k == 0) return;
  // zgemv of OpenBLAS 0.3.21 reads one number behind the vector (its issue 4013), which may be no memory.
  if constexpr (std::is_floating_point_v<Real>) {
    if (n == 1) {
      const std::size_t rows = op == CblasNoTrans ? m : k, columns = op == CblasNoTrans ? k : m;
      Blas<Real>::gemv(CblasColMajor, op, as_int(rows), as_int(columns), -1, a, as_int(lda), b, 1, 1, c, 1);
      return;
    }
  }
  Blas<Real>::gemm(CblasColMajor, op, CblasNoTrans, as_int(m), as_int(n), as_int(k), -1, a, as_int(lda), b, as_int(ldb),
                   1, c, as_int(ldc));
}

/// X := op(L)^-1 X.
template <typename Real>
void solve_triangular(CBLAS_TRANSPOSE op, std::size_t n, std::size_t columns, const Real* l, std::size_t ldl, Real* x,
                      std::size_t ldx, bool unit) {
  if (n == 0 || columns == 0) return;
  const CBLAS_DIAG diagonal = unit ? CblasUnit : CblasNonUnit;
  if (columns == 1) {
    Blas<Real>::trsv(CblasColMajor, CblasLower, op, diagonal, as_int(n), l, as_int(ldl), x, 1);
  } else {
    Blas<Real>::trsm(CblasColMajor, CblasLeft, CblasLower, op, diagonal, as_int(n), as_int(columns), 1, l, as_int(ldl),
                     x, as_int(ldx));
  }
}

}  // namespace

void use_one_thread_per_call() {
  openblas_set_num_threads(1);
}

template <typename Real>
int cholesky(std::size_t n, Real* a, std::size_t lda) {
  const int size = as_int(n), leading = as_int(lda);
  int info = 0;
  Blas<Real>::potrf("L", &size, a, &leading, &info);
  return info;
}

template <typename Real>
void solve_right_transposed(std::size_t m, std::size_t n, const Real* l, std::size_t ldl, Real* b, std::size_t ldb) {
  if (m == 0 || n == 0) return;
  Blas<Real>::trsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, as_int(m), as_int(n), 1, l,
                   as_int(ldl), b, as_int(ldb));
}

template <typename Real>
void subtract_square(std::size_t n, std::size_t k, const Real* a, std::size_t lda, Real* c, std::size_t ldc) {
  if (n == 0 || k == 0) return;
  Blas<Real>::syrk(CblasColMajor, CblasLower, CblasNoTrans, as_int(n), as_int(k), -1, a, as_int(lda), 1, c,
                   as_int(ldc));
}

template <typename Real>
void subtract_product_transposed(std::size_t m, std::size_t n, std::size_t k, const Real* a, std::size_t lda,
                                 const Real* b, std::size_t ldb, Real* c, std::size_t ldc) {
  if (m == 0 || n == 0 || k == 0) return;
  Blas<Real>::gemm(CblasColMajor, CblasNoTrans, CblasTrans, as_int(m), as_int(n), as_int(k), -1, a, as_int(lda), b,
                   as_int(ldb), 1, c, as_int(ldc));
}

template <typename Real>
void subtract_product(std::size_t m, std::size_t n, std::size_t k, const Real* a, std::size_t lda, const Real* b,
                      std::size_t ldb, Real* c, std::size_t ldc) {
  subtract_product_of(CblasNoTrans, {m, n, k}, a, lda, b, ldb, c, ldc);
}

template <typename Real>
void subtract_transposed_product(std::size_t m, std::size_t n, std::size_t k, const Real* a, std::size_t lda,
                                 const Real* b, std::size_t ldb, Real* c, std::size_t ldc) {
  subtract_product_of(CblasTrans, {m, n, k}, a, lda, b, ldb, c, ldc);
}

template <typename Real>
void solve_lower(std::size_t n, std::size_t columns, const Real* l, std::size_t ldl, Real* x, std::size_t ldx,
                 bool unit) {
  solve_triangular(CblasNoTrans, n, columns, l, ldl, x, ldx, unit);
}

template <typename Real>
void solve_lower_transposed(std::size_t n, std::size_t columns, const Real* l, std::size_t ldl, Real* x,
                            std::size_t ldx, bool unit) {
  solve_triangular(CblasTrans, n, columns, l, ldl, x, ldx, unit);
}

#define EQUIDEM_INSTANTIATE(Real)                                                                              \
  template void subtract_square(std::size_t, std::size_t, const Real*, std::size_t, Real*, std::size_t);       \
  template void subtract_product_transposed(std::size_t, std::size_t, std::size_t, const Real*, std::size_t,   \
                                            const Real*, std::size_t, Real*, std::size_t);                     \
  template void subtract_product(std::size_t, std::size_t, std::size_t, const Real*, std::size_t, const Real*, \
                                 std::size_t, Real*, std::size_t);                                             \
  template void subtract_transposed_product(std::size_t, std::size_t, std::size_t, const Real*, std::size_t,   \
                                            const Real*, std::size_t, Real*, std::size_t);                     \
  template void solve_lower(std::size_t, std::size_t, const Real*, std::size_t, Real*, std::size_t, bool);     \
  template void solve_lower_transposed(std::size_t, std::size_t, const Real*, std::size_t, Real*, std::size_t, bool)
EQUIDEM_INSTANTIATE(float);
EQUIDEM_INSTANTIATE(double);
EQUIDEM_INSTANTIATE(std::complex<double>);
#undef EQUIDEM_INSTANTIATE
#define EQUIDEM_INSTANTIATE(Real)                         \
  template int cholesky(std::size_t, Real*, std::size_t); \
  template void solve_right_transposed(std::size_t, std::size_t, const Real*, std::size_t, Real*, std::size_t)
EQUIDEM_INSTANTIATE(float);
EQUIDEM_INSTANTIATE(double);
#undef EQUIDEM_INSTANTIATE

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
