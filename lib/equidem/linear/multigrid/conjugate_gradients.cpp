// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/core/progress.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/large_buffer.hpp"

namespace equidem::multigrid {
namespace {

constexpr std::size_t numbers_at_once = 1 << 14;

/// The sum of f(begin, end) over pieces of the range, always in the same order.
template <typename Function>
double sum_over(std::size_t count, const Function& f) {
  std::vector<double> sums((count + numbers_at_once - 1) / numbers_at_once);
  parallel_ranges(count, numbers_at_once,
                  [&](std::size_t begin, std::size_t end) { sums[begin / numbers_at_once] = f(begin, end); });
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum;
}

double dot(std::span<const double> x, std::span<const double> y) {
  return sum_over(x.size(), [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += x[k] * y[k];
    return sum;
  });
}

/// y := y + factor x; returns |y|².
double add(double factor, std::span<const double> x, std::span<double> y) {
  return sum_over(x.size(), [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) {
      y[k] += factor * x[k];
      sum += y[k] * y[k];
    }
    return sum;
  });
}

/// p := z + factor p.
void turn(std::span<const double> z, double factor, std::span<double> p) {
  parallel_ranges(p.size(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) p[k] = z[k] + factor * p[k];
  });
}

}  // namespace

IterationReport conjugate_gradients(const Product& multiply_by_k, const Product& multiply_by_m, std::span<double> x,
                                    const IterationOptions& options) {
  const std::size_t n = x.size();
  LargeVector<double> r(x.begin(), x.end()), z(n), p(n), q(n);
  std::fill(x.begin(), x.end(), 0.0);
  IterationReport report;
  const double size = std::sqrt(dot(r, r));
  if (size == 0) return report;
  report.residual = 1;
  multiply_by_m(r, z);
  std::copy(z.begin(), z.end(), p.begin());
  double rz = dot(r, z);
  const double first_rz = rz;
  double inverse_size = rz;  // p.M^-1 p
  double largest_quotient = 0;
  Progress progress("iterating");
  while (report.iterations < options.max_iterations) {
    multiply_by_k(p, q);
    const double pq = dot(p, q);
    constexpr double no_stiffness = 1e-11;
    const double quotient = pq / inverse_size;  // of Rayleigh for M K
    largest_quotient = std::max(largest_quotient, quotient);
    if (!(rz > 0 && quotient > no_stiffness * largest_quotient)) {
      report.outcome = IterationOutcome::singular;
      return report;
    }
    const double alpha = rz / pq;
    add(alpha, p, x);
    report.residual = std::sqrt(add(-alpha, q, r)) / size;
    ++report.iterations;
    multiply_by_m(r, z);
    const double next_rz = dot(r, z);
    if (report.residual <= options.tolerance && next_rz <= options.tolerance * options.tolerance * first_rz) {
      return report;
    }
    progress.update(std::clamp(std::log(report.residual) / std::log(options.tolerance), 0.0, 1.0));
    const double beta = std::max(0.0, -alpha * dot(z, q) / rz);
    turn(z, beta, p);
    inverse_size = next_rz + beta * beta * inverse_size;
    rz = next_rz;
  }
  report.outcome = IterationOutcome::stalled;
  return report;
}

}  // namespace equidem::multigrid
