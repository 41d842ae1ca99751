// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Preconditioned conjugate gradients in double precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/core/stopwatch.hpp"
#include "equidem/linear/linear_solver.hpp"

namespace equidem::multigrid {

struct IterationOptions {
  double tolerance = 3e-7;  ///< of |r| over |b|, and a fourth of the estimated error over the solution, norms of energy
  /// In place of the tolerance, of the estimated error over the solution, norms of energy; 0: not asked for.
  double accuracy = 0;
  double energy = 0;  ///< that the error is compared with where it is larger than that of the solution
  int max_iterations = most_iterations;  ///< >= 1
};

enum class IterationOutcome {
  converged,
  stalled,   ///< the tolerance is not reached within max_iterations
  singular,  ///< a motion costs no energy, or a negative one
};

struct IterationReport {
  IterationOutcome outcome = IterationOutcome::converged;
  int iterations = 0;
  double residual = 0;      ///< |r| over |b| as the recurrence gives it
  double energy = 0;        ///< x.K x
  double energy_error = 0;  ///< e.K e of the error e, estimated: see ErrorEstimate
};

/// The energy of the error from that of the steps. With conjugate gradients each step takes t = alpha r.M r off e.K e
/// (Hestenes & Stiefel 1952, theorem 6:1), so that e.K e is the sum of all t to come (Strakos & Tichy 2002). These are
/// taken as a geometric series that falls by the square root of the slowest recent decay: decay slows down.
class ErrorEstimate {
 public:
  void add_step(double energy) {
    decay_ = last_ > 0 ? std::max(energy / last_, 0.5 * decay_) : decay_;
    last_ = energy;
    sum_ += energy;
    ++steps_;
  }
  [[nodiscard]] double energy() const { return sum_; }
  /// Infinity before the decay is known.
  [[nodiscard]] double error() const {
    constexpr int least = 3;
    if (steps_ < least || decay_ >= 1) return std::numeric_limits<double>::infinity();
    const double following = std::sqrt(decay_);
    return last_ * following / (1 - following);
  }

 private:
  double sum_ = 0, last_ = 0, decay_ = 0;
  int steps_ = 0;
};

/// Products of a vector z with r and with q.
struct Dots {
  double rz = 0, qz = 0;
};

/// Conjugate gradients (Hestenes & Stiefel 1952) for K x = b from x = 0. The step in the direction is that of Polak &
/// Ribiere, which tolerates the rounding of M, an approximate inverse of K in single precision (Notay 2000).
///
/// `Vectors` holds x = 0, r = b, p, q and z, and has
///   double size()             |r|
///   Dots precondition()       z = M r; returns r.z and q.z
///   void turn(double f)       p = z + f p
///   double multiply()         q = K p; returns p.q
///   double advance(double f)  x += f p, r -= f q; returns |r|
/// \throws Error of kind interrupted where the user asked to stop
template <class Vectors>
IterationReport iterate(Vectors& vectors, const IterationOptions& options) {
  IterationReport report;
  const double size = vectors.size();
  if (size == 0) return report;
  report.residual = 1;
  double rz = vectors.precondition().rz;
  vectors.turn(0);
  double inverse_size = rz;  // p.M^-1 p
  double largest_quotient = 0;
  ErrorEstimate estimate;
  Progress progress("iterating");
  while (report.iterations < options.max_iterations) {
    const double pq = vectors.multiply();
    constexpr double no_stiffness = 1e-11;
    const double quotient = pq / inverse_size;  // of Rayleigh for M K
    largest_quotient = std::max(largest_quotient, quotient);
    if (!(rz > 0 && quotient > no_stiffness * largest_quotient)) {
      report.outcome = IterationOutcome::singular;
      return report;
    }
    const double alpha = rz / pq;
    report.residual = vectors.advance(alpha) / size;
    ++report.iterations;
    estimate.add_step(alpha * rz);
    report.energy = estimate.energy();
    report.energy_error = report.residual == 0 ? 0 : estimate.error();
    const double wanted = options.accuracy > 0 ? options.accuracy : 4 * options.tolerance;
    const bool close = report.energy_error <= wanted * wanted * std::max(report.energy, options.energy);
    if (report.residual == 0 || (close && (options.accuracy > 0 || report.residual <= options.tolerance)))
      return report;
    const auto next = vectors.precondition();
    progress.update(std::clamp(std::log(report.residual) / std::log(options.tolerance), 0.0, 1.0));
    const double beta = std::max(0.0, -alpha * next.qz / rz);
    vectors.turn(beta);
    inverse_size = next.rz + beta * beta * inverse_size;
    rz = next.rz;
  }
  report.outcome = IterationOutcome::stalled;
  return report;
}

}  // namespace equidem::multigrid
