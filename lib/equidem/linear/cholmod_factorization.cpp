// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/cholmod_factorization.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>
#include <vector>

#include <cholmod.h>
#include <dlfcn.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {
namespace {

/// CHOLMOD's functions for one type of index.
template <typename Index>
struct Library;

template <>
struct Library<std::int32_t> {
  static constexpr int index_type = CHOLMOD_INT;
  static constexpr auto start = cholmod_start;
  static constexpr auto finish = cholmod_finish;
  static constexpr auto metis = cholmod_metis;
  static constexpr auto amd = cholmod_amd;
  static constexpr auto analyze = cholmod_analyze;
  static constexpr auto analyze_ordered = cholmod_analyze_p;
  static constexpr auto factorize = cholmod_factorize;
  static constexpr auto solve = cholmod_solve;
  static constexpr auto free_factor = cholmod_free_factor;
  static constexpr auto free_dense = cholmod_free_dense;
};

template <>
struct Library<SuiteSparse_long> {
  static constexpr int index_type = CHOLMOD_LONG;
  static constexpr auto start = cholmod_l_start;
  static constexpr auto finish = cholmod_l_finish;
  static constexpr auto metis = cholmod_l_metis;
  static constexpr auto amd = cholmod_l_amd;
  static constexpr auto analyze = cholmod_l_analyze;
  static constexpr auto analyze_ordered = cholmod_l_analyze_p;
  static constexpr auto factorize = cholmod_l_factorize;
  static constexpr auto solve = cholmod_l_solve;
  static constexpr auto free_factor = cholmod_l_free_factor;
  static constexpr auto free_dense = cholmod_l_free_dense;
};

/// Keeps CHOLMOD on the calling thread. As built by Debian, it requests four OpenMP threads at every supernode, a
/// request that outranks omp_set_num_threads and OMP_NUM_THREADS: most supernodes are small, and the threads cost
/// more than they bring. With no active parallel region allowed, each runs on its caller. The OpenMP runtime is the
/// one that CHOLMOD was linked with, if any, so its functions are found by name.
class OneThread {
 public:
  explicit OneThread(bool wanted) {
    if (!wanted) return;
    dense::use_one_thread_per_call();
    const auto get = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "omp_get_max_active_levels"));
    set_ = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"));
    if (get == nullptr || set_ == nullptr) return;
    before_ = get();
    set_(0);
  }
  ~OneThread() {
    if (set_ != nullptr) set_(before_);
  }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  void (*set_)(int) = nullptr;
  int before_ = 1;
};

enum class Outcome { positive, not_positive, indices_too_short };

template <typename Index>
class CholmodCholesky final : public Factorization {
 public:
  CholmodCholesky(double held_stiffness, CholmodOrdering ordering) : held_stiffness_(held_stiffness) {
    Library<Index>::start(&common_);
    common_.print = 0;
    common_.error_handler = nullptr;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.final_ll = 1;
    common_.quick_return_if_not_posdef = 1;
    report_.name = fmt::format("CHOLMOD supernodal Cholesky, {}", entry_of(ordering).in_reports);
    report_.negative_pivots = 0;
  }
  ~CholmodCholesky() override {
    Library<Index>::free_factor(&factor_, &common_);
    Library<Index>::finish(&common_);
  }

  Outcome factorize(CompressedColumns columns, CholmodOrdering ordering, StageTimes& times) {
    constexpr auto limit = static_cast<std::int64_t>(std::numeric_limits<Index>::max());
    if (std::max(columns.size, columns.first.back()) >= limit) return Outcome::indices_too_short;
    component_ = std::move(columns.component);
    if (component_.empty()) return Outcome::positive;
    std::vector<Index> first(columns.first.begin(), columns.first.end());
    std::vector<Index> rows(columns.rows.begin(), columns.rows.end());
    std::vector<std::int64_t>().swap(columns.first);
    std::vector<std::int64_t>().swap(columns.rows);
    cholmod_sparse matrix = {};
    matrix.nrow = matrix.ncol = component_.size();
    matrix.nzmax = rows.size();
    matrix.p = first.data();
    matrix.i = rows.data();
    matrix.x = columns.values.data();
    matrix.stype = -1;  // the lower triangle
    matrix.itype = Library<Index>::index_type;
    matrix.xtype = CHOLMOD_REAL;
    matrix.dtype = CHOLMOD_DOUBLE;
    matrix.sorted = matrix.packed = 1;

    if (!analyze(matrix, ordering, times)) return Outcome::indices_too_short;
    Stopwatch watch;
    Library<Index>::factorize(&matrix, factor_, &common_);
    if (common_.status < CHOLMOD_OK) fail("factorizing");
    times.add("factorization", watch.lap());
    const bool positive = common_.status != CHOLMOD_NOT_POSDEF;
    watch_pivots(positive, first, columns.values);
    return positive ? Outcome::positive : Outcome::not_positive;
  }

  void solve(std::span<double> x, int right_hand_sides) const override {
    const std::size_t free = component_.size(), columns = static_cast<std::size_t>(right_hand_sides);
    const std::size_t n = columns == 0 ? 0 : x.size() / columns;
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
    cholmod_dense* solution = Library<Index>::solve(CHOLMOD_A, factor_, &b, &common_);
    if (solution == nullptr) fail("solving with");
    const auto* y = static_cast<const double*>(solution->x);
    for (std::size_t c = 0; c < columns; ++c) {
      for (std::size_t k = 0; k < free; ++k) x[c * n + component_[k]] = y[c * solution->d + k];
    }
    Library<Index>::free_dense(&solution, &common_);
  }

  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  /// False where the index type is too short.
  bool analyze(cholmod_sparse& matrix, CholmodOrdering ordering, StageTimes& times) {
    // Ordering and analysis are called apart, so that each is timed; cholmod_analyze calls them likewise.
    Stopwatch watch;
    std::vector<Index> order;
    if (ordering != CholmodOrdering::equidem) {
      order.resize(matrix.nrow);
      if (ordering == CholmodOrdering::metis) {
        Library<Index>::metis(&matrix, nullptr, 0, false, order.data(), &common_);
      } else {
        Library<Index>::amd(&matrix, nullptr, 0, order.data(), &common_);
      }
      if (common_.status == CHOLMOD_TOO_LARGE) return false;
      if (common_.status != CHOLMOD_OK) fail("ordering");
    }
    times.add("ordering", watch.lap());
    common_.nmethods = 1;
    common_.method[0].ordering = order.empty() ? CHOLMOD_NATURAL : CHOLMOD_GIVEN;
    factor_ = order.empty() ? Library<Index>::analyze(&matrix, &common_)
                            : Library<Index>::analyze_ordered(&matrix, order.data(), nullptr, 0, &common_);
    if (common_.status == CHOLMOD_TOO_LARGE) return false;
    if (factor_ == nullptr) fail("analyzing");
    report_.nonzeros = common_.lnz;
    report_.bytes =
        static_cast<double>(factor_->xsize) * sizeof(double) + static_cast<double>(factor_->ssize) * sizeof(Index);
    times.add("analysis", watch.lap());
    return true;
  }

  void watch_pivots(bool positive, const std::vector<Index>& first, const std::vector<double>& values) {
    const auto* permutation = static_cast<const Index*>(factor_->Perm);
    if (!positive) {
      report_.smallest_pivot = 0;
      report_.smallest_component = component_[permutation[factor_->minor]];
      return;
    }
    assert(factor_->is_super);
    const auto* begin = static_cast<const Index*>(factor_->super);
    const auto* row_begin = static_cast<const Index*>(factor_->pi);
    const auto* value_begin = static_cast<const Index*>(factor_->px);
    const auto* l = static_cast<const double*>(factor_->x);
    for (std::size_t s = 0; s < factor_->nsuper; ++s) {
      const auto rows = static_cast<std::size_t>(row_begin[s + 1] - row_begin[s]);
      for (Index k = begin[s]; k < begin[s + 1]; ++k) {
        const double pivot = l[value_begin[s] + static_cast<std::size_t>(k - begin[s]) * (rows + 1)];
        const Index column = permutation[k];
        const double share = pivot * pivot / values[first[column]];  // a column begins with its diagonal
        if (report_.smallest_component >= 0 && share >= report_.smallest_pivot) continue;
        report_.smallest_pivot = share;
        report_.smallest_component = component_[column];
      }
    }
  }

  [[noreturn]] void fail(const char* doing) const {
    const std::string problem =
        fmt::format("{} the stiffness matrix of {} unknowns failed in CHOLMOD", doing, component_.size());
    if (common_.status == CHOLMOD_OUT_OF_MEMORY) {
      computation_failed(problem, "there is not enough memory", "Use a smaller assembly or a machine with more memory");
    }
    computation_failed(problem, fmt::format("its status is {}", common_.status),
                       "Choose another solver: method = \"multifrontal\"");
  }

  double held_stiffness_;
  std::vector<std::int64_t> component_;  // of each column
  mutable cholmod_common common_;        // its workspace is used by every call
  cholmod_factor* factor_ = nullptr;
  FactorReport report_;
};

struct Attempt {
  Outcome outcome;
  std::unique_ptr<Factorization> factor;
};

template <typename Index>
Attempt attempt(const MatrixOnGraph& k, const DegreesOfFreedom& unknowns, CholmodOrdering ordering,
                std::span<const std::int32_t> order, StageTimes& times) {
  Stopwatch watch;
  if (ordering != CholmodOrdering::equidem) order = {};
  CompressedColumns columns = compress(k.matrix, k.assembly, k.graph, unknowns, order);
  times.add("compression", watch.lap());
  auto factor = std::make_unique<CholmodCholesky<Index>>(held_stiffness(k.matrix, unknowns), ordering);
  const Outcome outcome = factor->factorize(std::move(columns), ordering, times);
  return {outcome, std::move(factor)};
}

}  // namespace

std::unique_ptr<Factorization> cholmod_cholesky(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns,
                                                CholmodOrdering ordering, std::span<const std::int32_t> order,
                                                FactorReport* report, CholmodTrial* trial) {
  assert(ordering != CholmodOrdering::equidem || order.size() == matrix.graph.size());
  const OneThread one_thread(trial == nullptr || !trial->keep_thread_settings);
  StageTimes times;
  auto [outcome, factor] = attempt<std::int32_t>(matrix, unknowns, ordering, order, times);
  if (outcome == Outcome::indices_too_short) {
    auto longer = attempt<SuiteSparse_long>(matrix, unknowns, ordering, order, times);
    outcome = longer.outcome;
    factor = std::move(longer.factor);
  }
  if (outcome == Outcome::indices_too_short) {
    computation_failed("the stiffness matrix is too large for CHOLMOD", "its factor would not fit into memory",
                       "Use a smaller assembly");
  }
  if (report != nullptr) *report = factor->report();
  if (trial != nullptr) trial->times = std::move(times);
  if (outcome == Outcome::not_positive) return nullptr;
  return std::move(factor);
}

std::unique_ptr<Factorization> factorize_by_cholmod(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns,
                                                    const SymbolicFactor& symbolic, const SolverOptions& options) {
  return cholmod_cholesky(matrix, unknowns, options.ordering, symbolic.tree.order);
}

}  // namespace equidem
