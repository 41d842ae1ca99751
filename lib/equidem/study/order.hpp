// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Order of convergence, extrapolation to the limit.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace equidem {

/// One level of a series of refinements.
struct Level {
  double h = 0;  ///< resolution, > 0: 1/rows, the time step, a tolerance; smaller is finer
  double error = 0;
};

/// error = constant h^order over the finest levels.
struct ObservedOrder {
  double order = 0;
  double uncertainty = 0;  ///< half width of the 95 % interval; NaN of two levels
  double constant = 0;
  double coarsest = 0, finest = 0;  ///< h, the range that was fitted
  std::size_t levels = 0;

  [[nodiscard]] double error_at(double h) const;
  /// The h with that error.
  [[nodiscard]] double resolution_for(double error) const;
};

/// Slope of log error over log h, least squares over the asymptotic range: at least four levels from the finest on
/// (where there are so many), and as many coarser ones as leave the slope known within twice the narrowest of these
/// intervals (Student's). Where errors do not scatter but bend, and the orders between neighbours settle, the last of
/// these, uncertain by its last change. Errors at or below `floor`, where rounding takes over, are left out, and so is
/// what is not finite; the same level twice counts once. Empty below two levels.
std::optional<ObservedOrder> observed_order(std::span<const Level> levels, double floor = 0);

/// The limit h -> 0 of f(h) = limit + c h^order from two levels (Richardson 1911).
double richardson_limit(double coarse_h, double coarse, double fine_h, double fine, double order);

/// The order p for which three levels lie on f = limit + c h^p: (f1 - f2)/(f2 - f3) = (h1^p - h2^p)/(h2^p - h3^p), by
/// bisection in [0.05, 20]. Empty where the values do not approach a limit that way. \param h descending
std::optional<double> order_of_three(std::span<const double, 3> h, std::span<const double, 3> values);

/// The factor by which time grows where errors fall by `factor`, for time ~ h^-cost and error ~ h^order:
/// factor^(cost/order).
double cost_of_accuracy(double factor, double cost_exponent, double order);

}  // namespace equidem
