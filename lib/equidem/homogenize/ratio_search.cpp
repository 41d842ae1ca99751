// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/ratio_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double smallest_ratio = 1e-8, largest_ratio = 1e6;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A value and a slope at one abscissa.
struct HermiteNode {
  double x, value, slope;
};

/// The polynomial of degree 2n - 1 through n nodes with their slopes, by Newton's divided differences with each
/// abscissa taken twice.
double hermite(const std::vector<HermiteNode>& nodes, double at) {
  const std::size_t count = 2 * nodes.size();
  std::vector<double> difference(count);
  for (std::size_t k = 0; k < count; ++k) difference[k] = nodes[k / 2].value;
  for (std::size_t order = 1; order < count; ++order) {
    for (std::size_t k = count - 1; k >= order; --k) {
      const HermiteNode &first = nodes[(k - order) / 2], &last = nodes[k / 2];
      difference[k] = order == 1 && k % 2 == 1 ? last.slope : (difference[k] - difference[k - 1]) / (last.x - first.x);
    }
  }
  double result = difference[count - 1];
  for (std::size_t k = count - 1; k-- > 0;) result = result * (at - nodes[k / 2].x) + difference[k];
  return result;
}

/// More nodes add rounding errors rather than digits.
constexpr std::size_t nodes_used = 3;

/// Only the nodes nearest to `at`.
double hermite_of_nearest(std::vector<HermiteNode> nodes, double at) {
  std::stable_sort(nodes.begin(), nodes.end(),
                   [&](const HermiteNode& a, const HermiteNode& b) { return std::abs(a.x - at) < std::abs(b.x - at); });
  if (nodes.size() > nodes_used) nodes.resize(nodes_used);
  return hermite(nodes, at);
}

/// The variable y of find_ratio.
class StretchedRange {
 public:
  explicit StretchedRange(const RatioRange& range)
      : at_zero_(range.at_zero), inverse_at_infinity_(1 / range.at_infinity) {
    // y - ln r at both ends; where q leaves an end in the wrong direction, that end says nothing.
    const double at_zero = std::log(range.smallest.slope / (1 - at_zero_ * inverse_at_infinity_));
    const double at_infinity = of(range.largest.shear_to_bulk) - std::log(range.largest.ratio);
    if (std::isfinite(at_zero) && std::isfinite(at_infinity)) {
      offset_ = (at_zero + at_infinity) / 2;
    } else if (std::isfinite(at_zero) || std::isfinite(at_infinity)) {
      offset_ = std::isfinite(at_zero) ? at_zero : at_infinity;
    }
  }

  [[nodiscard]] double of(double q) const { return std::log((q - at_zero_) / (1 - q * inverse_at_infinity_)); }
  /// dy/dq.
  [[nodiscard]] double slope(double q) const {
    return (1 - at_zero_ * inverse_at_infinity_) / ((q - at_zero_) * (1 - q * inverse_at_infinity_));
  }
  /// y - ln r, the mean of both ends.
  [[nodiscard]] double offset() const { return offset_; }

 private:
  double at_zero_, inverse_at_infinity_;
  double offset_ = 0;
};

bool near(double q, double wanted, double tolerance) {
  return std::abs(q - wanted) <= tolerance * wanted;
}

}  // namespace

RatioRange sample_range(const RatioSampler& sample) {
  RatioRange range{.smallest = sample(smallest_ratio), .largest = sample(largest_ratio)};
  range.at_zero = range.smallest.shear_to_bulk - range.smallest.ratio * range.smallest.slope;
  const RatioSample& end = range.largest;
  // d ln q / d ln r: 1 where q grows with r, near 0 where it is about to end.
  const double growth = end.ratio * end.slope / end.shear_to_bulk;
  constexpr double still_growing = 0.999;
  range.at_infinity = growth > still_growing ? infinity : end.shear_to_bulk / (1 - growth);
  return range;
}

FoundRatio find_ratio(const RatioSampler& sample, const RatioRange& range, double wanted, double tolerance) {
  assert(wanted >= range.at_zero * (1 - tolerance) && wanted <= range.at_infinity);
  constexpr int most_steps = 60;
  FoundRatio found;
  found.rising = range.smallest.slope > 0 && range.largest.slope >= 0;
  if (near(range.at_zero, wanted, tolerance)) {
    found.at = sample(0);
    found.steps = 1;
    found.reached = true;
    return found;
  }
  const StretchedRange stretched(range);
  const double y = stretched.of(wanted);
  double below = std::log(1e-15), above = std::log(1e15);  // ln r, with q < wanted and q > wanted
  double x = y - stretched.offset();
  std::vector<HermiteNode> nodes;
  while (found.steps < most_steps) {
    if (!(x > below && x < above)) x = (below + above) / 2;
    const RatioSample s = sample(std::exp(x));
    const double q = s.shear_to_bulk;
    found.at = s;
    ++found.steps;
    found.rising = found.rising && s.slope > 0;
    if (near(q, wanted, tolerance)) {
      found.reached = true;
      return found;
    }
    (q < wanted ? below : above) = x;
    const double inverse_slope = 1 / (stretched.slope(q) * s.ratio * s.slope);
    if (std::isfinite(stretched.of(q)) && inverse_slope > 0) nodes.push_back({stretched.of(q), x, inverse_slope});
    x = nodes.empty() ? (below + above) / 2 : hermite_of_nearest(nodes, y);
  }
  computation_failed(format("G/K = {:.9g} was not reached in {} steps, kT/kN lies between {:.9g} and {:.9g}", wanted,
                            most_steps, std::exp(below), std::exp(above)),
                     "G/K does not follow kT/kN smoothly there", "Ask for another Poisson's ratio or a larger sample");
}

FoundRatio find_negative_ratio(const RatioSampler& sample, const RatioRange& range, double wanted, double tolerance) {
  assert(wanted < range.at_zero);
  constexpr int most_steps = 60;
  constexpr double narrow = 1e-3;
  FoundRatio found;
  found.at = range.smallest;
  found.rising = range.smallest.slope > 0;
  const auto node = [](const RatioSample& s) { return HermiteNode{s.shear_to_bulk, s.ratio, 1 / s.slope}; };
  std::vector<HermiteNode> nodes{node(range.smallest)};
  double below = -infinity, above = 0;  // r, with q < wanted or unstable, and q > wanted
  bool limited = false;                 // `below` is unstable
  double x = hermite(nodes, wanted);
  while (found.steps < most_steps) {
    if (!(x > below && x < above)) x = std::isfinite(below) ? (below + above) / 2 : std::min(2 * above, -narrow);
    const RatioSample s = sample(x);
    ++found.steps;
    if (s.stable) {
      found.rising = found.rising && s.slope > 0;
      if (near(s.shear_to_bulk, wanted, tolerance)) {
        found.at = s;
        found.reached = true;
        return found;
      }
      if (s.shear_to_bulk > wanted && s.shear_to_bulk < found.at.shear_to_bulk) found.at = s;
      if (s.shear_to_bulk < wanted) limited = false;
      (s.shear_to_bulk < wanted ? below : above) = x;
      if (s.slope > 0) nodes.push_back(node(s));
      x = hermite_of_nearest(nodes, wanted);
    } else {
      limited = true;
      below = x;
      x = (below + above) / 2;
    }
    if (limited && (above - below <= narrow * -below || -below < 0.1 * narrow)) return found;
  }
  return found;
}

}  // namespace equidem
