// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/umfpack_factorization.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <umfpack.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {
namespace {

using Index = SuiteSparse_long;

static_assert(std::is_same_v<Index, std::int64_t>, "the indices of CompressedColumns are handed on");

/// The matrix and its factors, which outlive an interrupted factorization.
struct Work {
  CompressedColumns k;
  std::vector<double> imaginary;  ///< parts of the entries of k; empty: the matrix is real
  std::array<double, UMFPACK_CONTROL> control{};
  std::array<double, UMFPACK_INFO> info{};
  Index size = 0, status = UMFPACK_OK;
  bool complex = false, analyzed = false;
  void* numeric = nullptr;

  /// \param whole all entries, sorted by column and row
  explicit Work(CompressedColumns whole, std::vector<double> imaginary_in = {})
      : k(std::move(whole)), imaginary(std::move(imaginary_in)), size(k.size), complex(!imaginary.empty()) {
    umfpack_dl_defaults(control.data());          // the same of complex numbers
    control[UMFPACK_SCALE] = UMFPACK_SCALE_NONE;  // all entries of K have one unit
    // Diagonal pivots must pass the same test as others: where K is indefinite the default, 0.001, is lax.
    control[UMFPACK_SYM_PIVOT_TOLERANCE] = control[UMFPACK_PIVOT_TOLERANCE];
    control[UMFPACK_IRSTEP] = 0;  // refinement is done for all back ends alike
  }
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;
  ~Work() { complex ? umfpack_zl_free_numeric(&numeric) : umfpack_dl_free_numeric(&numeric); }

  void factorize() {
    const dense::OneThreadPerCall one_thread;
    const Index *first = k.first.data(), *rows = k.rows.data();
    const double *real = k.values.data(), *imag = imaginary.data();
    double *of_control = control.data(), *of_info = info.data();
    void* symbolic = nullptr;
    status = complex ? umfpack_zl_symbolic(size, size, first, rows, real, imag, &symbolic, of_control, of_info)
                     : umfpack_dl_symbolic(size, size, first, rows, real, &symbolic, of_control, of_info);
    if (status < UMFPACK_OK) return;
    analyzed = true;
    status = complex ? umfpack_zl_numeric(first, rows, real, imag, symbolic, &numeric, of_control, of_info)
                     : umfpack_dl_numeric(first, rows, real, symbolic, &numeric, of_control, of_info);
    complex ? umfpack_zl_free_symbolic(&symbolic) : umfpack_dl_free_symbolic(&symbolic);
  }

  [[nodiscard]] double factor_bytes() const { return info[UMFPACK_NUMERIC_SIZE] * info[UMFPACK_SIZE_OF_UNIT]; }

  [[noreturn]] void fail(const char* doing, Index failed) const {
    const std::string problem = fmt::format("{} the {}stiffness matrix of {} unknowns failed in UMFPACK", doing,
                                            complex ? "complex " : "", size);
    if (failed == UMFPACK_ERROR_out_of_memory) {
      out_of_memory(problem, "there is not enough memory", "Use a smaller assembly or a machine with more memory");
    }
    computation_failed(problem, fmt::format("its status is {}", failed),
                       complex ? "Choose another frequency" : "Choose another solver: method = \"multifrontal\"");
  }
};

/// UMFPACK asks for no signal, and the analysis of a long strip takes minutes.
/// \throws Error (computation_failed) where UMFPACK fails
void factorize(const std::shared_ptr<Work>& work) {
  constexpr Index small = 30000;  // less than a second
  if (work->size < small) {
    work->factorize();
  } else {
    run_aside([work] { work->factorize(); });
  }
  if (work->status < UMFPACK_OK) work->fail(work->analyzed ? "factorizing" : "analyzing", work->status);
}

class UmfpackLu final : public Factorization {
 public:
  explicit UmfpackLu(double held_stiffness) : held_stiffness_(held_stiffness) { report_.name = "UMFPACK LU"; }

  /// Whether no pivot is zero.
  bool factorize(CompressedColumns k) {
    component_ = k.component;
    if (component_.empty()) return true;
    work_ = std::make_shared<Work>(std::move(k));
    equidem::factorize(work_);
    report_.nonzeros = work_->info[UMFPACK_LNZ];
    report_.bytes = work_->factor_bytes();
    watch_pivots(work_->k);
    work_->k = {};
    return work_->status == UMFPACK_OK;
  }

  void solve(std::span<double> x, int right_hand_sides) override {
    const std::size_t free = component_.size(), columns = static_cast<std::size_t>(right_hand_sides);
    const std::size_t n = columns == 0 ? 0 : x.size() / columns;
    const dense::OneThreadPerCall one_thread;
    std::vector<double> b(free), y(free);
    for (std::size_t c = 0; c < columns; ++c) {
      double* column = &x[c * n];
      for (std::size_t k = 0; k < free; ++k) b[k] = column[component_[k]];
      for (std::size_t k = 0; k < n; ++k) column[k] /= held_stiffness_;
      if (free == 0) continue;
      const Index status = umfpack_dl_solve(UMFPACK_A, nullptr, nullptr, nullptr, y.data(), b.data(), work_->numeric,
                                            work_->control.data(), nullptr);
      if (status != UMFPACK_OK) work_->fail("solving with", status);
      for (std::size_t k = 0; k < free; ++k) column[component_[k]] = y[k];
    }
  }

  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  void watch_pivots(const CompressedColumns& k) {
    const std::size_t n = component_.size();
    std::vector<double> pivots(n);
    std::vector<Index> column_of(n);
    const Index status = umfpack_dl_get_numeric(nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr,
                                                column_of.data(), pivots.data(), nullptr, nullptr, work_->numeric);
    if (status != UMFPACK_OK) work_->fail("reading the factor of", status);
    for (std::size_t p = 0; p < n; ++p) {
      const Index c = column_of[p];
      double largest = 0;
      for (Index e = k.first[c]; e < k.first[c + 1]; ++e) largest = std::max(largest, std::abs(k.values[e]));
      const double share = largest > 0 ? std::abs(pivots[p]) / largest : 0.0;
      if (report_.smallest_component && share >= report_.smallest_pivot) continue;
      report_.smallest_pivot = share;
      report_.smallest_component = static_cast<std::size_t>(component_[c]);
    }
  }

  double held_stiffness_;
  std::vector<std::int64_t> component_;  // of each column
  std::shared_ptr<Work> work_;
  FactorReport report_;
};

}  // namespace

std::unique_ptr<Factorization> umfpack_lu(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns) {
  return umfpack_lu(with_upper_triangle(compress(matrix.matrix, matrix.assembly, matrix.graph, unknowns)),
                    held_stiffness(matrix.matrix, unknowns));
}

std::unique_ptr<Factorization> umfpack_lu(CompressedColumns whole, double held_stiffness) {
  auto factor = std::make_unique<UmfpackLu>(held_stiffness);
  if (!factor->factorize(std::move(whole))) return nullptr;
  return factor;
}

ComplexLu umfpack_complex_lu(const CompressedColumns& storage, const CompressedColumns& loss) {
  const auto work = std::make_shared<Work>(with_upper_triangle(storage), with_upper_triangle(loss).values);
  ComplexLu lu;
  if (work->size == 0) return lu;
  factorize(work);
  if (work->status != UMFPACK_OK) {
    computation_failed("at this frequency a pivot of the complex stiffness matrix is lost in round-off",
                       "normal and tangential springs are too far apart for the digits of a double",
                       "Choose a frequency at which both are within a factor of 1e10 of each other");
  }
  lu.bytes = work->factor_bytes();
  work->k.first = {}, work->k.rows = {}, work->k.values = {}, work->imaginary = {};
  lu.solve = [work](std::span<std::complex<double>> x) {
    // UMFPACK takes real and imaginary parts in turns where no array of imaginary parts is given.
    const auto& component = work->k.component;
    const dense::OneThreadPerCall one_thread;
    std::vector<std::complex<double>> b(component.size()), y(component.size());
    for (std::size_t k = 0; k < b.size(); ++k) b[k] = x[static_cast<std::size_t>(component[k])];
    const Index status = umfpack_zl_solve(
        UMFPACK_A, nullptr, nullptr, nullptr, nullptr, reinterpret_cast<double*>(y.data()), nullptr,
        reinterpret_cast<const double*>(b.data()), nullptr, work->numeric, work->control.data(), nullptr);
    if (status != UMFPACK_OK) work->fail("solving with", status);
    std::ranges::fill(x, 0.0);
    for (std::size_t k = 0; k < b.size(); ++k) x[static_cast<std::size_t>(component[k])] = y[k];
  };
  return lu;
}

std::unique_ptr<Factorization> factorize_by_umfpack(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns,
                                                    const SymbolicFactor&, const SolverOptions&) {
  return umfpack_lu(matrix, unknowns);
}

}  // namespace equidem
