// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/calibrate/ratio_search.hpp"

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
    // y - ln r at both ends; where q leaves an end in the wrong direction, that end is not used.
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

constexpr int most_steps = 60;

[[noreturn]] void not_followed(double wanted, double below, double above) {
  computation_failed(fmt::format("G/K = {:.9g} was not reached in {} steps, kT/kN lies between {:.9g} and {:.9g}",
                                 wanted, most_steps, std::min(below, above), std::max(below, above)),
                     "G/K does not follow kT/kN smoothly there", "Ask for another Poisson's ratio or a larger sample");
}

/// A sample on the axis on which it is interpolated: ln r, or r where that may be zero or negative.
HermiteNode on_axis(const RatioSample& s, bool logarithmic) {
  if (logarithmic) return {std::log(s.ratio), s.shear_to_bulk, s.ratio * s.slope};
  return {s.ratio, s.shear_to_bulk, s.slope};
}

/// The cubic through two nodes with their slopes, q(a.x + h t) for t in [0, 1].
struct Cubic {
  double value, rise, at_a, at_b;  ///< q(0), q(1) - q(0), dq/dt at both ends

  Cubic(const HermiteNode& a, const HermiteNode& b)
      : value(a.value), rise(b.value - a.value), at_a((b.x - a.x) * a.slope), at_b((b.x - a.x) * b.slope) {}

  [[nodiscard]] double operator()(double t) const {
    return value + t * (at_a + t * ((3 * rise - 2 * at_a - at_b) + t * (at_a + at_b - 2 * rise)));
  }
  [[nodiscard]] double slope(double t) const {
    return at_a + t * (2 * (3 * rise - 2 * at_a - at_b) + t * 3 * (at_a + at_b - 2 * rise));
  }
  /// Sufficient (Fritsch & Carlson 1980).
  [[nodiscard]] bool monotonic() const {
    return at_a * rise >= 0 && at_b * rise >= 0 && std::abs(at_a) <= 3 * std::abs(rise) &&
           std::abs(at_b) <= 3 * std::abs(rise);
  }
};

/// Sign change of f in [0, 1], given the signs at its ends.
template <class Function>
double root(const Function& f) {
  double low = 0, high = 1;
  const bool rises = f(1) > f(0);
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    ((f(middle) < 0) == rises ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// q = wanted between two stable samples on either side of it, by cubics through the ends of an ever smaller bracket.
FoundRatio find_between(const RatioSampler& sample, RatioSample a, RatioSample b, double wanted, double tolerance) {
  const bool logarithmic = a.ratio > 0;
  FoundRatio found;
  while (found.steps < most_steps) {
    const HermiteNode from = on_axis(a, logarithmic), to = on_axis(b, logarithmic);
    const Cubic cubic(from, to);
    // A bracket of which one end stays is cut through.
    const double t = found.steps % 4 == 3 ? 0.5 : root([&](double at) { return cubic(at) - wanted; });
    const double x = from.x + t * (to.x - from.x);
    const RatioSample s = sample(logarithmic ? std::exp(x) : x);
    ++found.steps;
    if (!s.stable) break;
    if (near(s.shear_to_bulk, wanted, tolerance)) {
      found.at = s;
      found.reached = true;
      return found;
    }
    ((s.shear_to_bulk < wanted) == (a.shear_to_bulk < b.shear_to_bulk) ? a : b) = s;
  }
  not_followed(wanted, a.ratio, b.ratio);
}

/// Samples in between, in order, until each piece is monotonic by the cubic through its ends.
void close_in(const RatioSampler& sample, const RatioSample& a, const RatioSample& b, std::vector<RatioSample>& out) {
  constexpr double sharp = 1e-9;
  const bool logarithmic = a.ratio > 0;
  const double fine = logarithmic ? 0.3 : -0.05 * out.front().ratio;
  const HermiteNode from = on_axis(a, logarithmic), to = on_axis(b, logarithmic);
  const Cubic cubic(from, to);
  if (cubic.monotonic()) return;
  const bool turns = cubic.at_a * cubic.at_b < 0;
  const double open = std::min(std::abs(cubic.at_a), std::abs(cubic.at_b));
  if (turns ? open <= sharp * a.shear_to_bulk : to.x - from.x <= fine) return;
  const double t = turns ? root([&](double at) { return cubic.slope(at); }) : 0.5;
  const double x = from.x + t * (to.x - from.x);
  const RatioSample s = sample(logarithmic ? std::exp(x) : x);
  if (!s.stable || !(s.ratio > a.ratio && s.ratio < b.ratio)) return;
  close_in(sample, a, s, out);
  out.push_back(s);
  close_in(sample, s, b, out);
}

/// The samples with those of close_in between them.
std::vector<RatioSample> pieces(const RatioSampler& sample, const std::vector<RatioSample>& coarse) {
  std::vector<RatioSample> all{coarse.front()};
  for (std::size_t k = 1; k < coarse.size(); ++k) {
    close_in(sample, coarse[k - 1], coarse[k], all);
    all.push_back(coarse[k]);
  }
  return all;
}

/// q = wanted in the piece nearest to r = 1, if there is one.
FoundRatio find_in_pieces(const RatioSampler& sample, const std::vector<RatioSample>& all, double wanted,
                          double tolerance) {
  const auto distance = [&](std::size_t k) {
    return std::max({0.0, 1 - all[k].ratio, all[k - 1].ratio > 0 ? 1 - 1 / all[k - 1].ratio : 0.0});
  };
  std::size_t best = 0;
  for (std::size_t k = 1; k < all.size(); ++k) {
    const bool inside = (all[k - 1].shear_to_bulk <= wanted) != (all[k].shear_to_bulk <= wanted);
    if (inside && (best == 0 || distance(k) < distance(best))) best = k;
  }
  FoundRatio found;
  if (best > 0) found = find_between(sample, all[best - 1], all[best], wanted, tolerance);
  found.rising = std::all_of(all.begin(), all.end(), [](const RatioSample& s) { return s.slope > 0; });
  return found;
}

}  // namespace

RatioRange sample_range(const RatioSampler& sample) {
  RatioRange range;
  double ratio = smallest_ratio;
  do range.smallest = sample(ratio);
  while (!range.smallest.stable && (ratio *= 100) <= 1.01);
  if (!range.smallest.stable) return range;
  ratio = largest_ratio;
  do range.largest = sample(ratio);
  while (!range.largest.stable && (ratio /= 100) >= 0.99);
  if (!range.largest.stable) return range;

  const RatioSample &start = range.smallest, &end = range.largest;
  // d ln q / d ln r: 1 where q grows with r, near 0 where it is about to end.
  const auto growth = [](const RatioSample& s) { return s.ratio * s.slope / s.shear_to_bulk; };
  constexpr double still_growing = 0.999, settled = 1e-3;
  range.closed = std::max(start.bulk_growth, start.bulk_growth + growth(start)) < settled;
  range.at_zero = start.shear_to_bulk - start.ratio * start.slope;
  range.at_infinity = growth(end) > still_growing ? infinity : end.shear_to_bulk / (1 - growth(end));
  const double first = range.closed ? range.at_zero : start.shear_to_bulk;
  const double last = std::isfinite(range.at_infinity) ? end.shear_to_bulk : infinity;
  range.least = std::min(first, last);
  range.greatest = std::max(first, last);
  range.rising = start.slope > 0 && end.slope >= 0 && range.at_zero < last;
  return range;
}

FoundRatio find_ratio(const RatioSampler& sample, const RatioRange& range, double wanted, double tolerance) {
  assert(wanted >= range.least * (1 - tolerance) && wanted <= range.greatest);
  FoundRatio found;
  found.rising = range.rising;
  if (range.closed && near(range.at_zero, wanted, tolerance)) {
    found.at = sample(0);
    found.steps = 1;
    found.reached = found.at.stable;
    return found;
  }
  const StretchedRange stretched(range);
  const double y = stretched.of(wanted);
  // ln r, with q < wanted and q > wanted
  double below = std::log(range.smallest.shear_to_bulk < wanted ? range.smallest.ratio : 1e-15);
  double above = std::log(range.largest.shear_to_bulk > wanted ? range.largest.ratio : 1e15);
  double x = y - stretched.offset();
  std::vector<HermiteNode> nodes;
  while (found.steps < most_steps) {
    if (!(x > below && x < above)) x = (below + above) / 2;
    const RatioSample s = sample(std::exp(x));
    const double q = s.shear_to_bulk;
    ++found.steps;
    if (!s.stable) {  // beyond the ends, lost in rounding
      (x < 0 ? below : above) = x;
      continue;
    }
    found.at = s;
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
  not_followed(wanted, std::exp(below), std::exp(above));
}

FoundRatio find_by_scan(const RatioSampler& sample, RatioRange& range, double wanted, double tolerance) {
  int count = 0;
  const RatioSampler counted = [&](double ratio) {
    ++count;
    return sample(ratio);
  };
  std::vector<RatioSample> coarse;
  if (range.closed) coarse.push_back({.shear_to_bulk = range.at_zero, .slope = range.smallest.slope});
  coarse.push_back(range.smallest);
  for (double ratio = 10 * range.smallest.ratio; ratio < 0.5 * range.largest.ratio; ratio *= 10) {
    const RatioSample s = counted(ratio);
    if (s.stable) coarse.push_back(s);
  }
  coarse.push_back(range.largest);
  const std::vector<RatioSample> all = pieces(counted, coarse);
  const auto [least, greatest] =
      std::minmax_element(all.begin(), all.end(),
                          [](const RatioSample& a, const RatioSample& b) { return a.shear_to_bulk < b.shear_to_bulk; });
  range.least = least->shear_to_bulk;
  range.greatest = greatest->shear_to_bulk;
  FoundRatio found = find_in_pieces(sample, all, wanted, tolerance);
  found.steps += count;
  return found;
}

namespace {

/// The stable sample within a thousandth of the limit of stability, by bisection.
RatioSample static_limit(const RatioSampler& sample, const RatioSample& stable) {
  constexpr double narrow = 1e-3, nothing = 1e-4, far = -1000;
  RatioSample last = stable;
  double unstable = -1;
  for (RatioSample s = sample(unstable); s.stable && unstable > far; s = sample(unstable)) {
    last = s;
    unstable *= 2;
  }
  while (last.ratio - unstable > narrow * -unstable && unstable < -nothing) {
    const double middle = (unstable + std::min(last.ratio, 0.0)) / 2;
    const RatioSample s = sample(middle);
    if (s.stable) {
      last = s;
    } else {
      unstable = middle;
    }
  }
  return last;
}

}  // namespace

FoundRatio find_negative_ratio(const RatioSampler& sample, const RatioRange& range, double wanted, double tolerance) {
  assert(range.closed && wanted < range.at_zero);
  constexpr double narrow = 1e-3;
  FoundRatio found;
  found.rising = range.smallest.slope > 0;
  const auto node = [](const RatioSample& s) { return HermiteNode{s.shear_to_bulk, s.ratio, 1 / s.slope}; };
  std::vector<HermiteNode> nodes{node(range.smallest)};
  double below = -infinity, above = 0;  // r, with q < wanted or unstable, and q > wanted
  bool limited = false;                 // `below` is unstable
  double x = hermite(nodes, wanted);
  while (found.steps < most_steps && !(limited && (above - below <= narrow * -below || -below < 0.1 * narrow))) {
    if (!(x > below && x < above)) x = std::isfinite(below) ? (below + above) / 2 : std::min(2 * above, -narrow);
    const RatioSample s = sample(x);
    ++found.steps;
    if (!s.stable) {
      limited = true;
      below = x;
      x = (below + above) / 2;
      continue;
    }
    found.rising = found.rising && s.slope > 0;
    if (near(s.shear_to_bulk, wanted, tolerance)) {
      found.at = s;
      found.reached = true;
      return found;
    }
    if (s.shear_to_bulk < wanted) limited = false;
    (s.shear_to_bulk < wanted ? below : above) = x;
    if (s.slope > 0) nodes.push_back(node(s));
    x = hermite_of_nearest(nodes, wanted);
  }
  found.at = range.smallest;
  if (limited && above == 0) return found;
  const RatioSampler counted = [&](double ratio) {
    ++found.steps;
    return sample(ratio);
  };
  const RatioSample limit = static_limit(counted, range.smallest);
  const std::vector<RatioSample> all = pieces(counted, {limit, range.smallest});
  FoundRatio last = find_in_pieces(sample, all, wanted, tolerance);
  if (!last.reached) {
    last.at = *std::min_element(all.begin(), all.end(), [](const RatioSample& a, const RatioSample& b) {
      return a.shear_to_bulk < b.shear_to_bulk;
    });
  }
  last.limit = limit.ratio;
  last.steps += found.steps;
  return last;
}

}  // namespace equidem
