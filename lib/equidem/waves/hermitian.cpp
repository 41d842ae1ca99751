// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/hermitian.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>

namespace equidem {
namespace {

using Matrix = Eigen::MatrixXcd;
using Solver = Eigen::SelfAdjointEigenSolver<Matrix>;

/// An eigenvalue below this share of the largest is zero up to round-off.
constexpr double zero_share = 1e-12;

Eigen::Map<const Matrix> view(const ComplexMatrix& m) {
  const auto n = static_cast<Eigen::Index>(m.size);
  return {m.entries.data(), n, n};
}

ComplexMatrix copy_of(const Matrix& m) {
  ComplexMatrix result(static_cast<std::size_t>(m.rows()));
  std::copy(m.data(), m.data() + m.size(), result.entries.begin());
  return result;
}

double largest_magnitude(const Solver& solver) {
  return solver.eigenvalues().size() == 0 ? 0 : solver.eigenvalues().cwiseAbs().maxCoeff();
}

/// D^+ B for a positive semidefinite D.
Matrix pseudo_solve(const Matrix& d, const Matrix& b) {
  const Solver solver(d);
  const double smallest = zero_share * largest_magnitude(solver);
  Eigen::VectorXd inverse = solver.eigenvalues();
  for (double& value : inverse) value = value > smallest ? 1 / value : 0;
  return solver.eigenvectors() * (inverse.asDiagonal() * (solver.eigenvectors().adjoint() * b));
}

}  // namespace

HermitianSpectrum spectrum(const ComplexMatrix& hermitian) {
  if (hermitian.size == 0) return {};
  const Solver solver(view(hermitian));
  const Eigen::VectorXd& values = solver.eigenvalues();
  return {{values.begin(), values.end()}, copy_of(solver.eigenvectors())};
}

std::vector<double> eigenvalues(const ComplexMatrix& hermitian) {
  if (hermitian.size == 0) return {};
  const Solver solver(view(hermitian), Eigen::EigenvaluesOnly);
  const Eigen::VectorXd& values = solver.eigenvalues();
  return {values.begin(), values.end()};
}

ComplexMatrix condense(const ComplexMatrix& matrix, const std::vector<char>& eliminated) {
  assert(eliminated.size() == matrix.size);
  std::vector<Eigen::Index> kept, gone;
  for (std::size_t k = 0; k < matrix.size; ++k)
    (eliminated[k] != 0 ? gone : kept).push_back(static_cast<Eigen::Index>(k));
  const auto whole = view(matrix);
  const Matrix a = whole(kept, kept);
  if (gone.empty()) return copy_of(a);
  const Matrix b = whole(kept, gone), d = whole(gone, gone);
  const Matrix left = a - b * pseudo_solve(d, b.adjoint());
  return copy_of(0.5 * (left + left.adjoint()));
}

double largest_share(const ComplexMatrix& n, const ComplexMatrix& t) {
  if (n.size == 0) return 0;
  const Solver sum(view(n) + view(t));
  const double smallest = zero_share * largest_magnitude(sum);
  const Eigen::VectorXd& values = sum.eigenvalues();
  const Eigen::Index first = std::upper_bound(values.begin(), values.end(), smallest) - values.begin();
  const Eigen::Index count = values.size() - first;
  if (count == 0) return 0;
  const Matrix whitened =
      sum.eigenvectors().rightCols(count) * values.tail(count).cwiseSqrt().cwiseInverse().asDiagonal();
  const Matrix share_t = whitened.adjoint() * view(t) * whitened;
  const double share = Solver(share_t, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
  return std::clamp(share, 0.0, 1.0);
}

LongWaves long_waves(const ComplexMatrix& d0, const ComplexMatrix& d1, const ComplexMatrix& d2) {
  const Solver solver(view(d0));
  const Eigen::VectorXd& values = solver.eigenvalues();
  const double smallest = 1e-11 * std::max(largest_magnitude(solver), view(d2).cwiseAbs().maxCoeff() * 1e-3);
  std::vector<Eigen::Index> zero, other;
  for (Eigen::Index k = 0; k < values.size(); ++k) (std::abs(values[k]) <= smallest ? zero : other).push_back(k);
  const Matrix z = solver.eigenvectors()(Eigen::all, zero);
  Matrix h = z.adjoint() * view(d2) * z;
  if (!other.empty()) {
    const Matrix y = solver.eigenvectors()(Eigen::all, other).adjoint() * (view(d1) * z);
    const Eigen::VectorXd inverse = values(other).cwiseInverse();
    h -= y.adjoint() * inverse.asDiagonal() * y;
  }
  LongWaves result;
  if (zero.empty()) return result;
  const Solver slow(0.5 * (h + h.adjoint()));
  result.squared_speeds.assign(slow.eigenvalues().begin(), slow.eigenvalues().end());
  const Matrix turned = z * slow.eigenvectors();
  for (Eigen::Index k = 0; k < turned.cols(); ++k)
    result.vectors.emplace_back(turned.col(k).data(), turned.col(k).data() + turned.rows());
  return result;
}

}  // namespace equidem
