// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The ends of the spectrum of a large symmetric operator.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

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

/// Lanczos from a random vector, which has a part in every eigenvector with probability one. Its vectors are not kept:
/// rounding lets them lose their orthogonality, but value and residual of the extreme Ritz pair stay what they are to
/// rounding, and only once it has converged copies of it appear (Paige 1980). Where the work allowed does not suffice
/// for the tolerance, which an end of the spectrum that is nearly continuous may cause, the last value is returned: see
/// `converged` and `residual`.
/// \param multiply y = A x, A symmetric, x and y of `size` components; must give the same bits for the same x
ExtremeEigenvalue extreme_eigenvalue(
    std::size_t size, const std::function<void(std::span<const double> x, std::span<double> y)>& multiply,
    SpectrumEnd end, const LanczosOptions& options = {});

}  // namespace equidem
