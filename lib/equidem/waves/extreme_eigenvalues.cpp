// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/extreme_eigenvalues.hpp"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Spectra/SymEigsSolver.h>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"

namespace equidem {
namespace {

using RealMatrix = Eigen::MatrixXd;
using RealVector = Eigen::VectorXd;
using Eigen::Index;

constexpr double rounding = 0x1.0p-51;

RealVector random_vector(std::size_t size, Random& random) {
  RealVector x(static_cast<Index>(size));
  for (double& value : x) value = random.uniform(-1, 1);
  return x;
}

/// A symmetric matrix becomes its eigenvectors; their eigenvalues, ascending.
RealVector diagonalize(RealMatrix& matrix) {
  RealVector values(matrix.rows());
  const dense::OneThreadPerCall one_thread;
  if (dense::find_spectrum(static_cast<std::size_t>(matrix.rows()), matrix.data(), values.data(), true) != 0) {
    computation_failed("the spectrum of a small matrix is not found", "",
                       "Report the case: this happens only where numbers are not finite");
  }
  return values;
}

/// y = A x in the form of Spectra; A of about the norm 1, since Spectra compares with 1.
struct Operator {
  using Scalar = double;
  Index size = 0;
  std::function<void(const double* x, double* y)> multiply;

  [[nodiscard]] Index rows() const { return size; }
  [[nodiscard]] Index cols() const { return size; }
  void perform_op(const double* x, double* y) const {
    stop_if_interrupted();
    multiply(x, y);
  }
};

/// Ritz pairs of the largest eigenvalues, those that have not converged too.
class Process : public Spectra::SymEigsSolver<Operator> {
 public:
  Process(Operator& a, Eigen::Index wanted, Eigen::Index vectors)
      : SymEigsSolver(a, wanted, std::min(vectors, a.size)), wanted_(wanted) {}

  void run(const Eigen::VectorXd& start, double tolerance, Eigen::Index restarts) {
    init(start.data());
    try {
      compute(Spectra::SortRule::LargestAlge, restarts, tolerance);
    } catch (const Error&) {  // of A x
      throw;
    } catch (const std::runtime_error& error) {
      computation_failed("the Lanczos process broke down", error.what(), "Report the case");
    }
    turns_ = this->m_fac.matrix_H();
    values_ = diagonalize(turns_);
  }
  /// The k-th largest.
  [[nodiscard]] double value(Eigen::Index k) const { return values_[column(k)]; }
  /// |A x - value x|.
  [[nodiscard]] double residual(Eigen::Index k) const {
    return std::abs(turns_(values_.size() - 1, column(k))) * this->m_fac.f_norm();
  }
  [[nodiscard]] Eigen::MatrixXd vectors() const {
    const Eigen::MatrixXd& v = this->m_fac.matrix_V();
    return v * turns_.rightCols(wanted_).rowwise().reverse();
  }

 private:
  [[nodiscard]] Eigen::Index column(Eigen::Index k) const { return values_.size() - 1 - k; }

  Eigen::Index wanted_;
  Eigen::VectorXd values_;
  Eigen::MatrixXd turns_;  // of the basis to Ritz vectors
};

constexpr std::size_t dense_limit = 60;

void solve_dense(const Operator& a, ExtremeEigenvalue& result) {
  RealMatrix matrix(a.size, a.size);
  const RealMatrix unit = RealMatrix::Identity(a.size, a.size);
  for (Index k = 0; k < a.size; ++k) a.perform_op(unit.col(k).data(), matrix.col(k).data());
  const RealVector values = diagonalize(matrix);
  result.converged = true;
  result.value = values[a.size - 1];
  result.residual = rounding * static_cast<double>(a.size) * values.cwiseAbs().maxCoeff();
}

void iterate(Operator& a, const RealVector& start, const LanczosOptions& options, ExtremeEigenvalue& result) {
  constexpr Index vectors = 24;
  const double most = std::max(2000.0, options.work / static_cast<double>(a.size));
  Process process(a, 1, vectors);
  process.run(start, 0.5 * options.tolerance, static_cast<Index>(2 * most / vectors));
  result.value = process.value(0);
  result.residual = process.residual(0) + rounding * std::abs(result.value);
  result.converged = result.residual <= options.tolerance * std::abs(result.value);
}

/// V (V^T x) is taken away from x, twice.
template <class Columns>
void make_orthogonal_to(const RealMatrix& v, Columns&& x) {
  if (v.cols() == 0) return;
  for (int pass = 0; pass < 2; ++pass) {
    const RealMatrix parts = v.transpose() * x;
    x.noalias() -= v * parts;
  }
}

RealMatrix side_by_side(const RealMatrix& a, const RealMatrix& b) {
  RealMatrix both(std::max(a.rows(), b.rows()), a.cols() + b.cols());
  if (a.cols() > 0) both.leftCols(a.cols()) = a;
  if (b.cols() > 0) both.rightCols(b.cols()) = b;
  return both;
}

RealMatrix orthonormal(const RealMatrix& x) {
  const Eigen::HouseholderQR<RealMatrix> qr(x);
  return qr.householderQ() * RealMatrix::Identity(x.rows(), x.cols());
}

class Lowest {
 public:
  Lowest(const SymmetricOperator& a, const RealMatrix& null, const LowestOptions& options)
      : a_(a), null_(null), options_(options), random_(options.seed) {}

  LowestEigenvalues run_dense() {
    const auto n = static_cast<Index>(a_.size), wanted = static_cast<Index>(options_.wanted);
    RealMatrix matrix = times(RealMatrix::Identity(n, n));
    // Zero-energy modes, and components beyond the space, go to the far end of the spectrum.
    const double far = 10 * static_cast<double>(n) * matrix.diagonal().maxCoeff();
    matrix += far * null_ * null_.transpose();
    for (Index k = 0; k < n; ++k) {
      if (!(matrix(k, k) > 0)) matrix(k, k) = far;
    }
    diagonalize(matrix);
    const RealMatrix x = matrix.leftCols(wanted), ax = times(x);
    const RealVector values = x.cwiseProduct(ax).colwise().sum();
    deliver(x, values, (ax - x * values.asDiagonal()).colwise().norm());
    result_.converged = true;
    return std::move(result_);
  }

  LowestEigenvalues run() {
    Progress progress("natural frequencies");
    const auto wanted = static_cast<Index>(options_.wanted), dimension = static_cast<Index>(a_.dimension);
    std::vector<double> values;
    RealMatrix x = search(wanted, RealMatrix(null_.rows(), 0), 0.1 * options_.tolerance, values);
    while (x.cols() < dimension) {
      progress.update(0.5);
      std::nth_element(values.begin(), values.begin() + wanted - 1, values.end());
      const double last = values[static_cast<std::size_t>(wanted - 1)];
      x = side_by_side(x, search(1, x, 1e-6, values));
      constexpr double alike = 1e-5;
      if (values.back() >= (1 - alike) * last) break;
    }
    correct(std::move(x), progress);
    return std::move(result_);
  }

 private:
  [[nodiscard]] RealMatrix times(const RealMatrix& x) const {
    RealMatrix y(x.rows(), x.cols());
    a_.multiply(span_of(x), {y.data(), static_cast<std::size_t>(y.size())});
    return y;
  }
  void solve(double* x, Index columns) const { a_.solve({x, a_.size * static_cast<std::size_t>(columns)}); }
  static std::span<const double> span_of(const RealMatrix& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

  void deliver(const RealMatrix& x, const RealVector& values, const RealVector& bounds) {
    const auto wanted = static_cast<Index>(options_.wanted);
    result_.values.assign(values.data(), values.data() + wanted);
    result_.error_bounds.assign(bounds.data(), bounds.data() + wanted);
    result_.vectors.assign(x.data(), x.data() + wanted * x.rows());
  }

  /// Eigenvectors to the largest eigenvalues of A^-1 beside those found; the eigenvalues of A are appended to `values`.
  RealMatrix search(Index wanted, const RealMatrix& found, double tolerance, std::vector<double>& values) {
    const RealMatrix left_out = side_by_side(null_, found);
    double scale = 1;
    Operator inverse{.size = static_cast<Index>(a_.size), .multiply = [&](const double* from, double* to) {
                       Eigen::Map<RealVector> y(to, static_cast<Index>(a_.size));
                       y = Eigen::Map<const RealVector>(from, static_cast<Index>(a_.size));
                       make_orthogonal_to(left_out, y);
                       solve(to, 1);
                       make_orthogonal_to(left_out, y);
                       y *= scale;
                       ++result_.iterations;
                     }};
    RealVector start = random_vector(a_.size, random_), next(start.size());
    for (int power = 0; power < 2; ++power) {
      start.normalize();
      inverse.perform_op(start.data(), next.data());
      std::swap(start, next);
    }
    scale = 1 / start.norm();
    const auto free = static_cast<Index>(a_.dimension) - found.cols();
    constexpr Index restarts = 50;
    Process process(inverse, wanted, std::min(static_cast<Index>(lanczos_vectors(options_.wanted)), free));
    process.run(start, tolerance, restarts);
    for (Index k = 0; k < wanted; ++k) values.push_back(scale / process.value(k));
    return process.vectors();
  }

  /// X := X - A^-1 (A X - X values), until the bounds keep the tolerance. With A x = value x + r, |x| = 1,
  ///
  ///   r.A^-1 r = sum_j (lambda_j - value)²/lambda_j (x.x_j)² >= min_j (lambda_j - value)²/lambda_j,
  ///
  /// a bound that rounding of r, mostly in high eigenvectors, hardly touches.
  void correct(RealMatrix x, Progress& progress) {
    constexpr double safety = 1.2;
    const auto wanted = static_cast<Index>(options_.wanted);
    RealVector bounds;
    for (int step = 0;; ++step, ++result_.iterations) {
      make_orthogonal_to(null_, x);
      x = orthonormal(x);
      RealMatrix ax = times(x);
      RealMatrix turns = x.transpose() * ax;
      diagonalize(turns);
      x = (x * turns).eval();
      ax = times(x);  // anew, for what turning rounds off
      const RealVector values = x.cwiseProduct(ax).colwise().sum();
      RealMatrix r = ax - x * values.asDiagonal();
      make_orthogonal_to(null_, r);
      RealMatrix w = r;
      solve(w.data(), w.cols());
      make_orthogonal_to(null_, w);
      bounds = r.cwiseProduct(w).colwise().sum().transpose().cwiseMax(0).cwiseProduct(values.cwiseMax(0));
      bounds = safety * bounds.cwiseSqrt();
      result_.converged = (bounds.array() <= options_.tolerance * values.array()).head(wanted).all();
      if (result_.converged || step == options_.corrections) {
        deliver(x, values, bounds);
        return;
      }
      progress.update(0.9);
      x -= w;
    }
  }

  const SymmetricOperator& a_;
  const RealMatrix& null_;
  const LowestOptions& options_;
  Random random_;
  LowestEigenvalues result_;
};

}  // namespace

ExtremeEigenvalue extreme_eigenvalue(std::size_t size,
                                     const std::function<void(std::span<const double>, std::span<double>)>& multiply,
                                     SpectrumEnd end, const LanczosOptions& options) {
  ExtremeEigenvalue result;
  if (size == 0) return result;
  Random random(options.seed);
  const RealVector start = random_vector(size, random);
  RealVector y(start.size());
  multiply({start.data(), size}, {y.data(), size});
  const double largest = y.cwiseAbs().maxCoeff();
  result.converged = largest == 0;  // nothing resists anything
  if (result.converged) return result;
  const double scale = end == SpectrumEnd::largest ? largest : -largest;
  Operator a{.size = static_cast<Index>(size), .multiply = [&](const double* from, double* to) {
               multiply({from, size}, {to, size});
               Eigen::Map<RealVector>(to, static_cast<Index>(size)) /= scale;
               ++result.products;
             }};
  if (size <= dense_limit) {
    solve_dense(a, result);
  } else {
    iterate(a, start, options, result);
  }
  ++result.products;
  result.value *= scale;
  result.residual *= largest;
  return result;
}

LowestEigenvalues lowest_eigenvalues(const SymmetricOperator& a, std::span<const double> null,
                                     const LowestOptions& options) {
  const auto size = static_cast<Index>(a.size);
  const RealMatrix basis = Eigen::Map<const RealMatrix>(null.data(), size, static_cast<Index>(null.size()) / size);
  Lowest lowest(a, basis, options);
  const bool dense = a.size <= options.dense_limit || a.dimension < 2 * lanczos_vectors(options.wanted);
  return dense ? lowest.run_dense() : lowest.run();
}

bool make_orthonormal(std::size_t size, std::span<double> vectors) {
  if (vectors.empty()) return true;
  const auto rows = static_cast<Index>(size);
  Eigen::Map<RealMatrix> x(vectors.data(), rows, static_cast<Index>(vectors.size()) / rows);
  x.colwise().normalize();
  Eigen::ColPivHouseholderQR<RealMatrix> qr(x);
  constexpr double dependent = 3e-7;
  qr.setThreshold(dependent);
  x = qr.householderQ() * RealMatrix::Identity(x.rows(), x.cols());
  return qr.rank() == x.cols();
}

}  // namespace equidem
