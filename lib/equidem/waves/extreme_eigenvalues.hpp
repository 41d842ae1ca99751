// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Eigenvalues at the ends of the spectrum of a large symmetric operator, by the restarted Lanczos process of Spectra.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace equidem {

enum class SpectrumEnd { largest, smallest };

/// An eigenvalue with what is known of its error: some eigenvalue lies within `residual` of it, and since the method
/// maximizes (minimizes) the Rayleigh quotient, the true end of the spectrum is not less far out than value - residual.
struct ExtremeEigenvalue {
  double value = 0;
  double residual = 0;        ///< |A x - value x|, |x| = 1, of the vector x of the process, and rounding
  std::int64_t products = 0;  ///< A times a vector
  bool converged = false;     ///< to the tolerance
};

struct LanczosOptions {
  double tolerance = 1e-12;  ///< of the residual, relative to the eigenvalue
  double work = 1e10;        ///< steps times size at most, where that is more than 2000 steps
  std::uint64_t seed = 1;    ///< of the starting vector
};

/// Lanczos from a random vector, which has a part in every eigenvector with probability one. Where the work allowed
/// does not suffice for the tolerance, which an end of the spectrum that is nearly continuous may cause, the last value
/// is returned: see `converged` and `residual`.
/// \param multiply y = A x, A symmetric, x and y of `size` components; must give the same bits for the same x
ExtremeEigenvalue extreme_eigenvalue(
    std::size_t size, const std::function<void(std::span<const double> x, std::span<double> y)>& multiply,
    SpectrumEnd end, const LanczosOptions& options = {});

/// A symmetric positive semidefinite operator A. Vectors lie one after another; each function must give the same bits
/// for the same vectors.
struct SymmetricOperator {
  std::size_t size = 0;       ///< components of a vector; those beyond the space have rows and columns of zeros
  std::size_t dimension = 0;  ///< of the space without the null space of A, >= the number wanted
  std::function<void(std::span<const double> x, std::span<double> y)> multiply;  ///< y = A x
  std::function<void(std::span<double> x)> solve;  ///< x := A^-1 x; null vectors may be added
};

struct LowestOptions {
  std::size_t wanted = 4;         ///< number of eigenvalues, >= 1
  double tolerance = 1e-6;        ///< of `error_bounds`, relative to the eigenvalue
  int corrections = 20;           ///< steps of inverse iteration at the end, at most
  std::size_t dense_limit = 150;  ///< components up to which the whole spectrum is computed
  std::uint64_t seed = 1;         ///< of the starting vectors
};

/// Vectors of the Lanczos process for `wanted` eigenvalues.
constexpr std::size_t lanczos_vectors(std::size_t wanted) {
  return 2 * wanted + 16;
}

/// Ascending. Some eigenvalue of A lies within `error_bounds[k]` of `values[k]`, as far as `solve` has its first
/// digits; `values[k]` is not below the k-th eigenvalue. Eigenvalues are not counted, as the inertia of A - s I would:
/// a `solve` that is 20 % wrong can miss one.
struct LowestEigenvalues {
  std::vector<double> values;
  std::vector<double> error_bounds;  ///< sqrt(value r.A^-1 r), r = A x - value x, |x| = 1, with a margin
  std::vector<double> vectors;       ///< x, one after another
  int iterations = 0;                ///< solutions with single vectors, and corrections; 0: the whole spectrum
  bool converged = false;            ///< to the tolerance
};

/// Lanczos for A^-1 (shift and invert, with the shift 0). One process finds a multiple eigenvalue only as often as
/// rounding lets it: processes from other vectors, orthogonal to all eigenvectors found, follow until one shows no
/// eigenvalue among the wanted. Inverse iteration with quotients of Rayleigh then corrects values and vectors, which
/// keeps the digits of eigenvalues that are small beside the rounding of `solve`.
/// \param null orthonormal basis of the null space of A, which is left out
LowestEigenvalues lowest_eigenvalues(const SymmetricOperator& a, std::span<const double> null,
                                     const LowestOptions& options = {});

/// Makes vectors of `size` components, one after another, orthonormal.
/// \returns false where they are dependent to working precision
[[nodiscard]] bool make_orthonormal(std::size_t size, std::span<double> vectors);

}  // namespace equidem
