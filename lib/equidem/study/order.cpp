// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "equidem/core/statistics.hpp"

namespace equidem {
namespace {

/// The line through all of these.
ObservedOrder fit(std::span<const Level> levels) {
  const auto n = static_cast<double>(levels.size());
  double x = 0, y = 0;
  for (const Level& level : levels) {
    x += std::log(level.h) / n;
    y += std::log(level.error) / n;
  }
  double xx = 0, xy = 0, left = 0;
  for (const Level& level : levels) {
    const double u = std::log(level.h) - x, v = std::log(level.error) - y;
    xx += u * u;
    xy += u * v;
  }
  ObservedOrder result{.order = xy / xx, .levels = levels.size()};
  for (const Level& level : levels) {
    const double off = std::log(level.error) - y - result.order * (std::log(level.h) - x);
    left += off * off;
  }
  const auto freedom = static_cast<std::int64_t>(levels.size()) - 2;
  result.uncertainty =
      freedom < 1 ? std::numeric_limits<double>::quiet_NaN()
                  : student_critical_value(0.95, freedom) * std::sqrt(left / (static_cast<double>(freedom) * xx));
  result.constant = std::exp(y - result.order * x);
  result.coarsest = levels.front().h;
  result.finest = levels.back().h;
  return result;
}

/// Where the orders between neighbouring levels approach a limit smoothly, each change of one sign and smaller than the
/// one before by `smooth`, there is no scatter but curvature: the last order, uncertain by its last change. Empty where
/// they do not.
std::optional<ObservedOrder> order_that_settles(std::span<const Level> levels) {
  constexpr std::size_t needed = 5;
  constexpr double smooth = 0.7;
  if (levels.size() < needed) return {};
  const auto finest = levels.last(needed);
  std::array<double, needed - 1> order{};
  for (std::size_t k = 0; k + 1 < needed; ++k) {
    if (finest[k].h == finest[k + 1].h) return {};
    order[k] = std::log(finest[k].error / finest[k + 1].error) / std::log(finest[k].h / finest[k + 1].h);
  }
  for (std::size_t k = 2; k + 1 < needed; ++k) {
    const double before = order[k - 1] - order[k - 2], now = order[k] - order[k - 1];
    if (!(now * before >= 0 && std::abs(now) <= smooth * std::abs(before))) return {};
  }
  ObservedOrder result = fit(finest.last(2));
  result.uncertainty = std::abs(order[needed - 2] - order[needed - 3]);
  result.levels = needed;
  result.coarsest = finest.front().h;
  return result;
}

}  // namespace

double ObservedOrder::error_at(double h) const {
  return constant * std::pow(h, order);
}

double ObservedOrder::resolution_for(double error) const {
  return std::pow(error / constant, 1 / order);
}

std::optional<ObservedOrder> observed_order(std::span<const Level> levels, double floor) {
  std::vector<Level> usable;
  for (const Level& level : levels) {
    if (level.h > 0 && std::isfinite(level.h) && std::isfinite(level.error) && level.error > std::max(floor, 0.0))
      usable.push_back(level);
  }
  std::sort(usable.begin(), usable.end(), [](const Level& a, const Level& b) { return a.h > b.h; });
  const auto same = [](const Level& a, const Level& b) { return a.h == b.h && a.error == b.error; };
  usable.erase(std::unique(usable.begin(), usable.end(), same), usable.end());
  if (usable.size() < 2 || usable.front().h == usable.back().h) return {};
  std::vector<ObservedOrder> fits;  // of ever more levels
  for (std::size_t count = std::min<std::size_t>(usable.size(), 4); count <= usable.size(); ++count) {
    const auto finest = std::span<const Level>(usable).last(count);
    if (finest.front().h != finest.back().h) fits.push_back(fit(finest));
  }
  if (fits.empty()) return {};
  double least = fits.front().uncertainty;
  for (const ObservedOrder& one : fits) least = std::min(least, one.uncertainty);
  ObservedOrder best = fits.front();
  for (const ObservedOrder& one : fits) {
    if (one.uncertainty <= 2 * least) best = one;
  }
  const auto settling = order_that_settles(usable);
  return settling && settling->uncertainty < best.uncertainty ? settling : best;
}

double richardson_limit(double coarse_h, double coarse, double fine_h, double fine, double order) {
  return fine + (fine - coarse) / (std::pow(coarse_h / fine_h, order) - 1);
}

std::optional<double> order_of_three(std::span<const double, 3> h, std::span<const double, 3> values) {
  const double wanted = (values[0] - values[1]) / (values[1] - values[2]);
  if (!(wanted > 0) || !std::isfinite(wanted) || !(h[0] > h[1] && h[1] > h[2] && h[2] > 0)) return {};
  const double up = h[0] / h[1], down = h[2] / h[1];
  const auto ratio = [&](double p) { return (std::pow(up, p) - 1) / (1 - std::pow(down, p)); };  // rises with p
  double low = 0.05, high = 20;
  if (wanted < ratio(low) || wanted > ratio(high)) return {};
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (ratio(middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double cost_of_accuracy(double factor, double cost_exponent, double order) {
  return std::pow(factor, cost_exponent / order);
}

}  // namespace equidem
