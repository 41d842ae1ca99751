// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/lanczos.hpp"

#include <Eigen/Core>
#include <algorithm>

#include <Spectra/SymEigsSolver.h>

#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"

namespace equidem {
namespace {

using Product = std::function<void(std::span<const double>, std::span<double>)>;

/// Operator for Spectra, scaled to about 1: its tolerances are absolute for eigenvalues below 4e-11.
class Operator {
 public:
  using Scalar = double;

  Operator(std::size_t size, const Product& multiply, double scale) : size_(size), multiply_(multiply), scale_(scale) {}
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(size_); }
  [[nodiscard]] Eigen::Index cols() const { return rows(); }
  void perform_op(const double* x, double* y) const {
    stop_if_interrupted();
    multiply_({x, size_}, {y, size_});
    for (std::size_t k = 0; k < size_; ++k) y[k] /= scale_;
  }

 private:
  std::size_t size_;
  const Product& multiply_;
  double scale_;
};

Eigen::VectorXd starting_vector(Eigen::Index size, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd x(size);
  for (double& value : x) value = random.uniform(-1, 1);
  return x;
}

/// Small enough for the whole spectrum.
void solve_dense(const Operator& a, SpectrumEnd end, ExtremeEigenvalue& result) {
  Eigen::MatrixXd matrix(a.rows(), a.rows());
  for (Eigen::Index k = 0; k < a.rows(); ++k) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(a.rows(), k);
    a.perform_op(unit.data(), matrix.col(k).data());
  }
  result.products = a.rows();
  std::vector<double> values(result.products);
  dense::use_one_thread_per_call();
  if (dense::find_spectrum(values.size(), matrix.data(), values.data(), true) != 0) return;
  const auto x = matrix.col(end == SpectrumEnd::largest ? a.rows() - 1 : 0);
  result.vector.assign(x.begin(), x.end());
  result.converged = true;
}

/// One run to one tolerance; false, with no vector, where the restarts do not suffice.
bool iterate(Operator& a, SpectrumEnd end, const LanczosOptions& options, double tolerance, ExtremeEigenvalue& result) {
  const Eigen::VectorXd start = starting_vector(a.rows(), options.seed);
  const double most = std::max(2000.0, options.work / static_cast<double>(a.rows()));
  Spectra::SymEigsSolver<Operator> solver(a, 1, std::min<Eigen::Index>(options.subspace, a.rows()));
  solver.init(start.data());
  const auto rule = end == SpectrumEnd::largest ? Spectra::SortRule::LargestAlge : Spectra::SortRule::SmallestAlge;
  solver.compute(rule, static_cast<Eigen::Index>(most / options.subspace), tolerance);
  result.products += solver.num_operations();
  if (solver.info() != Spectra::CompInfo::Successful) return false;
  const Eigen::VectorXd x = solver.eigenvectors().col(0).normalized();
  result.vector.assign(x.begin(), x.end());
  return true;
}

}  // namespace

ExtremeEigenvalue extreme_eigenvalue(std::size_t size, const Product& multiply, SpectrumEnd end,
                                     const LanczosOptions& options) {
  ExtremeEigenvalue result;
  if (size == 0) return result;
  const Eigen::VectorXd start = starting_vector(static_cast<Eigen::Index>(size), options.seed);
  std::vector<double> y(size);
  multiply({start.data(), size}, y);
  const Eigen::Map<Eigen::VectorXd> product(y.data(), start.size());
  const double scale = product.stableNorm() / start.norm();
  result.converged = scale == 0;  // nothing resists anything
  if (result.converged) return result;
  Operator a(size, multiply, scale);
  constexpr std::size_t dense_limit = 60;
  if (size <= dense_limit) {
    solve_dense(a, end, result);
  } else {
    for (double tolerance = options.tolerance; tolerance < 0.1 && result.vector.empty(); tolerance *= 1e4)
      result.converged = iterate(a, end, options, tolerance, result) && tolerance == options.tolerance;
  }
  if (result.vector.empty()) return result;
  const Eigen::Map<const Eigen::VectorXd> x(result.vector.data(), start.size());
  multiply(result.vector, y);
  result.value = x.dot(product);
  result.residual = (product - result.value * x).stableNorm();
  return result;
}

}  // namespace equidem
