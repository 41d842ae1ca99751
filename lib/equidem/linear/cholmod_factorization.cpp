// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/cholmod_factorization.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <cholmod.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

// OpenMP declares this in a header that not every compiler brings.
extern "C" {
int omp_get_max_active_levels();
void omp_set_max_active_levels(int levels);
}

namespace equidem {
namespace {

/// Keeps CHOLMOD on the calling thread. It requests four OpenMP threads at every supernode, a request that outranks
/// omp_set_num_threads and OMP_NUM_THREADS: most supernodes are small, and the threads cost more than they bring. With
/// no active parallel region allowed, each runs on its caller.
class OneThread {
 public:
  OneThread() { omp_set_max_active_levels(0); }
  ~OneThread() { omp_set_max_active_levels(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  dense::OneThreadPerCall blas_;
  int before_ = omp_get_max_active_levels();
};

/// The matrix and its factor, which outlive an interrupted factorization. With 32-bit indices: with those of 64 bits
/// CHOLMOD takes 8 % longer at 3e5 unknowns, and what they allow beyond, a factor of 2^31 numbers, takes 17 GB.
struct CholmodFactor {
  CompressedColumns columns;
  cholmod_common common;  ///< its workspace is used by every call
  cholmod_factor* factor = nullptr;

  CholmodFactor(CompressedColumns lower, CholmodOrdering ordering) : columns(std::move(lower)) {
    // The factor is first touched on huge pages: half the time at 1e5 discs where they are given on request.
#if SUITESPARSE_VERSION >= SUITESPARSE_VER_CODE(6, 0)
    SuiteSparse_config_malloc_func_set(allocate_on_huge_pages);
#else
    SuiteSparse_config.malloc_func = allocate_on_huge_pages;
#endif
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
    common.quick_return_if_not_posdef = 1;
    common.nmethods = 1;
    common.method[0].ordering = ordering == CholmodOrdering::metis ? CHOLMOD_METIS
                                : ordering == CholmodOrdering::amd ? CHOLMOD_AMD
                                                                   : CHOLMOD_NATURAL;
  }
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;
  ~CholmodFactor() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }

  void factorize() {
    const OneThread one_thread;
    std::vector<int> first(columns.first.begin(), columns.first.end()), rows(columns.rows.begin(), columns.rows.end());
    cholmod_sparse matrix = {};
    matrix.nrow = matrix.ncol = columns.component.size();
    matrix.nzmax = rows.size();
    matrix.p = first.data();
    matrix.i = rows.data();
    matrix.x = columns.values.data();
    matrix.stype = -1;  // the lower triangle
    matrix.itype = CHOLMOD_INT;
    matrix.xtype = CHOLMOD_REAL;
    matrix.dtype = CHOLMOD_DOUBLE;
    matrix.sorted = matrix.packed = 1;
    factor = cholmod_analyze(&matrix, &common);
    if (factor == nullptr) return;
    cholmod_factorize(&matrix, factor, &common);
  }
};

class CholmodCholesky final : public Factorization {
 public:
  CholmodCholesky(double held_stiffness, CholmodOrdering ordering) : held_stiffness_(held_stiffness) {
    report_.name = fmt::format("CHOLMOD supernodal Cholesky, {}", entry_of(ordering).in_reports);
    report_.negative_pivots = 0;
  }

  /// Whether K is positive definite.
  bool factorize(CompressedColumns columns, CholmodOrdering ordering) {
    component_ = columns.component;
    if (component_.empty()) return true;
    if (columns.rows.size() > std::numeric_limits<int>::max()) fail("compressing", CHOLMOD_TOO_LARGE);
    work_ = std::make_shared<CholmodFactor>(std::move(columns), ordering);
    constexpr std::size_t small = 30000;  // less than a second
    if (component_.size() < small) {
      work_->factorize();
    } else {
      run_aside([work = work_] { work->factorize(); });
    }
    const int status = work_->common.status;
    if (status < CHOLMOD_OK) fail(work_->factor == nullptr ? "analyzing" : "factorizing", status);
    const bool positive = status != CHOLMOD_NOT_POSDEF;
    report_.nonzeros = work_->common.lnz;
    report_.bytes = static_cast<double>(work_->factor->xsize) * sizeof(double) +
                    static_cast<double>(work_->factor->ssize) * sizeof(int);
    watch_pivots(positive, *work_->factor, work_->columns);
    work_->columns = {};
    return positive;
  }

  void solve(std::span<double> x, int right_hand_sides) override {
    const std::size_t free = component_.size(), columns = static_cast<std::size_t>(right_hand_sides);
    const std::size_t n = columns == 0 ? 0 : x.size() / columns;
    const OneThread one_thread;
    std::vector<double> given(free * columns);
    for (std::size_t c = 0; c < columns; ++c) {
      for (std::size_t k = 0; k < free; ++k) given[c * free + k] = x[c * n + component_[k]];
    }
    for (double& value : x) value /= held_stiffness_;
    if (given.empty()) return;
    cholmod_dense b = {};
    b.nrow = b.d = free;
    b.ncol = columns;
    b.nzmax = given.size();
    b.x = given.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* solution = cholmod_solve(CHOLMOD_A, work_->factor, &b, &work_->common);
    if (solution == nullptr) fail("solving with", work_->common.status);
    const auto* y = static_cast<const double*>(solution->x);
    for (std::size_t c = 0; c < columns; ++c) {
      for (std::size_t k = 0; k < free; ++k) x[c * n + component_[k]] = y[c * solution->d + k];
    }
    cholmod_free_dense(&solution, &work_->common);
  }

  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  void watch_pivots(bool positive, const cholmod_factor& factor, const CompressedColumns& k) {
    const auto* permutation = static_cast<const int*>(factor.Perm);
    if (!positive) {
      report_.smallest_pivot = 0;
      report_.smallest_component = static_cast<std::size_t>(component_[permutation[factor.minor]]);
      return;
    }
    assert(factor.is_super);
    const auto* begin = static_cast<const int*>(factor.super);
    const auto* row_begin = static_cast<const int*>(factor.pi);
    const auto* value_begin = static_cast<const int*>(factor.px);
    const auto* l = static_cast<const double*>(factor.x);
    for (std::size_t s = 0; s < factor.nsuper; ++s) {
      const auto rows = static_cast<std::size_t>(row_begin[s + 1] - row_begin[s]);
      for (int c = begin[s]; c < begin[s + 1]; ++c) {
        const double pivot = l[value_begin[s] + static_cast<std::size_t>(c - begin[s]) * (rows + 1)];
        const int column = permutation[c];
        const double share = pivot * pivot / k.values[k.first[column]];  // a column begins with its diagonal
        if (report_.smallest_component && share >= report_.smallest_pivot) continue;
        report_.smallest_pivot = share;
        report_.smallest_component = static_cast<std::size_t>(component_[column]);
      }
    }
  }

  [[noreturn]] void fail(const char* doing, int status) const {
    const std::string problem =
        fmt::format("{} the stiffness matrix of {} unknowns failed in CHOLMOD", doing, component_.size());
    if (status == CHOLMOD_OUT_OF_MEMORY) {
      out_of_memory(problem, "there is not enough memory", "Use a smaller assembly or a machine with more memory");
    }
    computation_failed(problem,
                       status == CHOLMOD_TOO_LARGE ? "its indices of 32 bits do not number the entries of the factor"
                                                   : fmt::format("its status is {}", status),
                       "Choose another solver: method = \"multifrontal\"");
  }

  double held_stiffness_;
  std::vector<std::int64_t> component_;  // of each column
  std::shared_ptr<CholmodFactor> work_;
  FactorReport report_;
};

}  // namespace

std::unique_ptr<Factorization> cholmod_cholesky(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns,
                                                CholmodOrdering ordering, std::span<const std::int32_t> order) {
  assert(ordering != CholmodOrdering::equidem || order.size() == matrix.graph.size());
  if (ordering != CholmodOrdering::equidem) order = {};
  auto factor = std::make_unique<CholmodCholesky>(held_stiffness(matrix.matrix, unknowns), ordering);
  const bool positive =
      factor->factorize(compress(matrix.matrix, matrix.assembly, matrix.graph, unknowns, order), ordering);
  if (!positive) return nullptr;
  return factor;
}

std::unique_ptr<Factorization> factorize_by_cholmod(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns,
                                                    const SymbolicFactor& symbolic, const SolverOptions& options) {
  return cholmod_cholesky(matrix, unknowns, options.ordering, symbolic.tree.order);
}

}  // namespace equidem
