// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The ends of the spectrum of a large symmetric operator.
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
  double residual = 0;         ///< |A x - value x|, |x| = 1
  std::vector<double> vector;  ///< x
  std::int64_t products = 0;   ///< A times a vector
  bool converged = false;      ///< to the tolerance
};

struct LanczosOptions {
  double tolerance = 1e-12;  ///< of the residual, relative to the eigenvalue
  int subspace = 40;         ///< Lanczos vectors kept, > 2
  double work = 1e10;        ///< products times size at most, where that is more than 2000 products
  std::uint64_t seed = 1;    ///< of the starting vector
};

/// Implicitly restarted Lanczos from a random vector, which has a part in every eigenvector with probability one. Where
/// the work allowed does not suffice for the tolerance, which an end of the spectrum that is nearly continuous may
/// cause, looser ones are tried with as much work each: see `converged` and `residual`.
/// \param multiply y = A x, A symmetric, x and y of `size` components; must give the same bits for the same x
ExtremeEigenvalue extreme_eigenvalue(
    std::size_t size, const std::function<void(std::span<const double> x, std::span<double> y)>& multiply,
    SpectrumEnd end, const LanczosOptions& options = {});

}  // namespace equidem
