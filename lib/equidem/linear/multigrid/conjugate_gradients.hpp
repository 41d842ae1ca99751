// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Preconditioned conjugate gradients in double precision.
#pragma once

#include <functional>
#include <span>

namespace equidem::multigrid {

/// y := A x.
using Product = std::function<void(std::span<const double> x, std::span<double> y)>;

struct IterationOptions {
  double tolerance = 3e-7;   ///< of |r| over |b|, and of the energy norm of the error as r.M r shows it
  int max_iterations = 250;  ///< >= 1
};

enum class IterationOutcome {
  converged,
  stalled,   ///< the tolerance is not reached within max_iterations
  singular,  ///< a motion costs no energy, or a negative one
};

struct IterationReport {
  IterationOutcome outcome = IterationOutcome::converged;
  int iterations = 0;
  double residual = 0;  ///< |r| over |b| as the recurrence gives it
};

/// x := K^-1 b by conjugate gradients (Hestenes & Stiefel 1952), M an approximate inverse of K. The step in the
/// direction is that of Polak & Ribiere, which tolerates the rounding of M in single precision (Notay 2000).
/// \param x b on entry
/// \throws Error of kind interrupted where the user asked to stop
IterationReport conjugate_gradients(const Product& multiply_by_k, const Product& multiply_by_m, std::span<double> x,
                                    const IterationOptions& options = {});

}  // namespace equidem::multigrid
