// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/umfpack_factorization.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include <umfpack.h>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {
namespace {

using Index = SuiteSparse_long;

static_assert(std::is_same_v<Index, std::int64_t>, "the indices of CompressedColumns are handed on");

class UmfpackLu final : public Factorization {
 public:
  explicit UmfpackLu(double held_stiffness) : held_stiffness_(held_stiffness) {
    umfpack_dl_defaults(control_.data());
    control_[UMFPACK_SCALE] = UMFPACK_SCALE_NONE;  // all entries of K have one unit
    // Diagonal pivots must pass the same test as others: where K is indefinite the default, 0.001, is lax.
    control_[UMFPACK_SYM_PIVOT_TOLERANCE] = control_[UMFPACK_PIVOT_TOLERANCE];
    control_[UMFPACK_IRSTEP] = 0;  // refinement is done for all back ends alike
    report_.name = "UMFPACK LU";
  }

  /// Whether no pivot is zero.
  bool factorize(CompressedColumns k) {
    component_ = std::move(k.component);
    if (component_.empty()) return true;
    work_ = std::make_shared<Work>();
    work_->k = std::move(k);
    work_->control = control_;
    work_->size = static_cast<Index>(component_.size());
    constexpr Index small = 30000;  // less than a second
    if (work_->size < small) {
      work_->factorize();
    } else {
      run_aside();
    }
    if (work_->status < UMFPACK_OK) fail(work_->analyzed ? "factorizing" : "analyzing", work_->status);
    report_.nonzeros = work_->info[UMFPACK_LNZ];
    report_.bytes = work_->info[UMFPACK_NUMERIC_SIZE] * work_->info[UMFPACK_SIZE_OF_UNIT];
    watch_pivots(work_->k);
    work_->k = {};
    return work_->status == UMFPACK_OK;
  }

  void solve(std::span<double> x, int right_hand_sides) const override {
    const std::size_t free = component_.size(), columns = static_cast<std::size_t>(right_hand_sides);
    const std::size_t n = columns == 0 ? 0 : x.size() / columns;
    std::vector<double> b(free), y(free);
    for (std::size_t c = 0; c < columns; ++c) {
      double* column = &x[c * n];
      for (std::size_t k = 0; k < free; ++k) b[k] = column[component_[k]];
      for (std::size_t k = 0; k < n; ++k) column[k] /= held_stiffness_;
      if (free == 0) continue;
      const Index status = umfpack_dl_solve(UMFPACK_A, nullptr, nullptr, nullptr, y.data(), b.data(), work_->numeric,
                                            control_.data(), nullptr);
      if (status != UMFPACK_OK) fail("solving with", status);
      for (std::size_t k = 0; k < free; ++k) column[component_[k]] = y[k];
    }
  }

  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  /// What UMFPACK works on, which outlives an interrupted factorization.
  struct Work {
    CompressedColumns k;
    std::array<double, UMFPACK_CONTROL> control{};
    std::array<double, UMFPACK_INFO> info{};
    Index size = 0, status = UMFPACK_OK;
    bool analyzed = false;
    void* numeric = nullptr;

    Work() = default;
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;
    ~Work() { umfpack_dl_free_numeric(&numeric); }

    void factorize() {
      void* symbolic = nullptr;
      status = umfpack_dl_symbolic(size, size, k.first.data(), k.rows.data(), k.values.data(), &symbolic,
                                   control.data(), info.data());
      if (status < UMFPACK_OK) return;
      analyzed = true;
      status = umfpack_dl_numeric(k.first.data(), k.rows.data(), k.values.data(), symbolic, &numeric, control.data(),
                                  info.data());
      umfpack_dl_free_symbolic(&symbolic);
    }
  };

  /// UMFPACK asks for no signal, and the analysis of a long strip takes minutes: a thread of its own does the work and
  /// is left behind where the user interrupts.
  void run_aside() {
    std::promise<void> promise;
    const std::future<void> done = promise.get_future();
    std::thread aside([work = work_, promise = std::move(promise)]() mutable {
      work->factorize();
      promise.set_value();
    });
    try {
      while (done.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) stop_if_interrupted();
    } catch (...) {
      aside.detach();
      throw;
    }
    aside.join();
  }

  void watch_pivots(const CompressedColumns& k) {
    const std::size_t n = component_.size();
    std::vector<double> pivots(n);
    std::vector<Index> column_of(n);
    const Index status = umfpack_dl_get_numeric(nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr,
                                                column_of.data(), pivots.data(), nullptr, nullptr, work_->numeric);
    if (status != UMFPACK_OK) fail("reading the factor of", status);
    for (std::size_t p = 0; p < n; ++p) {
      const Index c = column_of[p];
      double largest = 0;
      for (Index e = k.first[c]; e < k.first[c + 1]; ++e) largest = std::max(largest, std::abs(k.values[e]));
      const double share = largest > 0 ? std::abs(pivots[p]) / largest : 0.0;
      if (report_.smallest_component >= 0 && share >= report_.smallest_pivot) continue;
      report_.smallest_pivot = share;
      report_.smallest_component = component_[c];
    }
  }

  [[noreturn]] void fail(const char* doing, Index status) const {
    const std::string problem =
        fmt::format("{} the stiffness matrix of {} unknowns failed in UMFPACK", doing, component_.size());
    if (status == UMFPACK_ERROR_out_of_memory) {
      computation_failed(problem, "there is not enough memory", "Use a smaller assembly or a machine with more memory");
    }
    computation_failed(problem, fmt::format("its status is {}", status),
                       "Choose another solver: method = \"multifrontal\"");
  }

  double held_stiffness_;
  std::array<double, UMFPACK_CONTROL> control_{};
  std::vector<std::int64_t> component_;  // of each column
  std::shared_ptr<Work> work_;
  FactorReport report_;
};

}  // namespace

std::unique_ptr<Factorization> umfpack_lu(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns,
                                          FactorReport* report) {
  dense::use_one_thread_per_call();
  auto factor = std::make_unique<UmfpackLu>(held_stiffness(matrix.matrix, unknowns));
  CompressedColumns whole = compress(matrix.matrix, matrix.assembly, matrix.graph, unknowns);
  whole = with_upper_triangle(whole);
  const bool regular = factor->factorize(std::move(whole));
  if (report != nullptr) *report = factor->report();
  if (!regular) return nullptr;
  return factor;
}

std::unique_ptr<Factorization> umfpack_lu(CompressedColumns whole, double held_stiffness) {
  dense::use_one_thread_per_call();
  auto factor = std::make_unique<UmfpackLu>(held_stiffness);
  if (!factor->factorize(std::move(whole))) return nullptr;
  return factor;
}

std::unique_ptr<Factorization> factorize_by_umfpack(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns,
                                                    const SymbolicFactor&, const SolverOptions&) {
  return umfpack_lu(matrix, unknowns);
}

}  // namespace equidem
