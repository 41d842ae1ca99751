// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/calibrate/ratio_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include <boost/math/tools/toms748_solve.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double smallest_ratio = 1e-8, largest_ratio = 1e6;
constexpr double infinity = std::numeric_limits<double>::infinity();

bool near(double q, double wanted, double tolerance) {
  return std::abs(q - wanted) <= tolerance * wanted;
}

constexpr int most_steps = 60;

[[noreturn]] void not_followed(double wanted, double below, double above) {
  computation_failed(fmt::format("G/K = {:.9g} was not reached in {} steps, kT/kN lies between {:.9g} and {:.9g}",
                                 wanted, most_steps, std::min(below, above), std::max(below, above)),
                     "G/K does not follow kT/kN smoothly there", "Ask for another Poisson's ratio or a larger sample");
}

/// The abscissa of a sample: ln r, or r where that may be zero or negative.
struct Axis {
  bool logarithmic;
  [[nodiscard]] double of(const RatioSample& s) const { return logarithmic ? std::log(s.ratio) : s.ratio; }
  [[nodiscard]] double ratio(double x) const { return logarithmic ? std::exp(x) : x; }
  [[nodiscard]] double slope(const RatioSample& s) const { return logarithmic ? s.ratio * s.slope : s.slope; }
};

/// The sample that continues q to r = 0.
RatioSample end_at_zero(const RatioRange& range) {
  return {.shear_to_bulk = range.at_zero, .slope = range.smallest.slope};
}

/// A zero of f between two abscissas with values of opposite sign (Alefeld, Potra & Shi 1995); ends where f is 0.
template <class Function>
std::pair<double, double> zero_between(const Function& f, double from, double to, double at_from, double at_to) {
  std::uintmax_t steps = most_steps;
  const auto narrow = [](double a, double b) { return std::abs(b - a) <= 1e-15 * std::max(std::abs(a), std::abs(b)); };
  return boost::math::tools::toms748_solve(f, from, to, at_from, at_to, narrow, steps);
}

/// q = wanted between two stable samples on either side of it.
FoundRatio find_between(const RatioSampler& sample, const RatioSample& a, const RatioSample& b, double wanted,
                        double tolerance) {
  const Axis axis{a.ratio > 0};
  FoundRatio found;
  double last = 0;
  // Convergence is faster than linear: one sample more, at most, gives the digits that the tolerance leaves open.
  const auto excess = [&](const RatioSample& s) {
    const double off = s.shear_to_bulk - wanted;
    if (!near(s.shear_to_bulk, wanted, tolerance)) return off;
    const bool done = found.reached || near(s.shear_to_bulk, wanted, 0.01 * tolerance);
    found.at = s;
    found.reached = true;
    return done ? 0.0 : off;
  };
  const auto at = [&](double x) {
    const RatioSample s = sample(axis.ratio(x));
    ++found.steps;
    last = s.ratio;
    if (!s.stable) not_followed(wanted, a.ratio, b.ratio);
    return excess(s);
  };
  const double at_a = excess(a), at_b = excess(b);
  double low = axis.of(a), high = axis.of(b);
  if (at_a != 0 && at_b != 0) std::tie(low, high) = zero_between(at, low, high, at_a, at_b);
  if (!found.reached) not_followed(wanted, axis.ratio(low), axis.ratio(high));
  if (found.steps == 0 || last != found.at.ratio) at(axis.of(found.at));  // the last sample is that of the result
  return found;
}

/// Sufficient for q to be monotonic between two samples, by the cubic through them with their slopes (Fritsch &
/// Carlson 1980).
bool monotonic(const RatioSample& a, const RatioSample& b, const Axis& axis) {
  const double width = axis.of(b) - axis.of(a), rise = b.shear_to_bulk - a.shear_to_bulk;
  const double at_a = width * axis.slope(a), at_b = width * axis.slope(b);
  return at_a * rise >= 0 && at_b * rise >= 0 && std::max(std::abs(at_a), std::abs(at_b)) <= 3 * std::abs(rise);
}

/// The extremum between two samples with slopes of opposite sign. \returns its ratio, or that of a sample next to it
/// that is not stable
RatioSample extremum(const RatioSampler& sample, const RatioSample& a, const RatioSample& b, const Axis& axis) {
  constexpr double sharp = 1e-6;  // of d ln q, whose square is the error of q
  RatioSample last = a;
  const auto slope = [&](double x) {
    const RatioSample s = sample(axis.ratio(x));
    if (!s.stable || !last.stable) return last.stable = false, 0.0;
    last = s;
    return std::abs(axis.slope(s)) * (axis.of(b) - axis.of(a)) <= sharp * s.shear_to_bulk ? 0.0 : axis.slope(s);
  };
  zero_between(slope, axis.of(a), axis.of(b), axis.slope(a), axis.slope(b));
  return last;
}

/// Samples in between, in order, until each piece is monotonic.
void close_in(const RatioSampler& sample, const RatioSample& a, const RatioSample& b, std::vector<RatioSample>& out) {
  const Axis axis{a.ratio > 0};
  const double fine = axis.logarithmic ? 0.3 : -0.05 * out.front().ratio;
  if (monotonic(a, b, axis)) return;
  const bool turns = a.slope * b.slope < 0;
  if (!turns && axis.of(b) - axis.of(a) <= fine) return;
  const RatioSample s = turns ? extremum(sample, a, b, axis) : sample(axis.ratio((axis.of(a) + axis.of(b)) / 2));
  if (!s.stable || !(s.ratio > a.ratio && s.ratio < b.ratio)) return;
  if (!turns) close_in(sample, a, s, out);
  out.push_back(s);
  if (!turns) close_in(sample, s, b, out);
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
  int count = 0;
  bool rising = range.rising;
  const RatioSampler counted = [&](double ratio) {
    ++count;
    RatioSample s = sample(ratio);
    rising = rising && (!s.stable || s.slope > 0);
    return s;
  };
  FoundRatio found;
  if (range.closed && near(range.at_zero, wanted, tolerance)) {
    found.at = counted(0);
    found.reached = found.at.stable;
  } else if (range.closed && wanted < range.smallest.shear_to_bulk) {
    found = find_in_pieces(counted, {end_at_zero(range), range.smallest}, wanted, tolerance);
  } else {
    constexpr double farthest = 1e15;
    RatioSample from = counted(1), to = from;
    const bool up = from.shear_to_bulk <= wanted;
    while (to.stable && (to.shear_to_bulk <= wanted) == up && to.ratio < farthest && to.ratio > 1 / farthest) {
      from = to;
      to = counted(up ? 10 * from.ratio : 0.1 * from.ratio);
    }
    if (to.stable && (to.shear_to_bulk <= wanted) != up)
      found = find_in_pieces(counted, up ? std::vector{from, to} : std::vector{to, from}, wanted, tolerance);
  }
  found.steps = count;
  found.rising = rising;
  return found;
}

FoundRatio find_by_scan(const RatioSampler& sample, RatioRange& range, double wanted, double tolerance) {
  int count = 0;
  const RatioSampler counted = [&](double ratio) {
    ++count;
    return sample(ratio);
  };
  std::vector<RatioSample> coarse;
  if (range.closed) coarse.push_back(end_at_zero(range));
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

FoundRatio find_negative_ratio(const RatioSampler& sample, const RatioRange& range, double wanted, double tolerance) {
  assert(range.closed && wanted < range.at_zero);
  constexpr double narrow = 5e-5, nothing = 1e-4, far = -1000;
  int count = 0;
  const RatioSampler counted = [&](double ratio) {
    ++count;
    return sample(ratio);
  };
  // Down to the first q < wanted, or to the limit of stability.
  std::vector<RatioSample> all{range.smallest};
  double unstable = -infinity;
  const auto reached = [&] { return all.front().shear_to_bulk <= wanted; };
  while (!reached() && all.front().ratio > far) {
    const double last = std::min(all.front().ratio, 0.0);
    if (std::isfinite(unstable) && (last - unstable <= narrow * -unstable || -unstable <= nothing)) break;
    const RatioSample s = counted(std::isfinite(unstable) ? (unstable + last) / 2 : last < 0 ? 2 * last : -1);
    if (s.stable) {
      all.insert(all.begin(), s);
    } else {
      unstable = s.ratio;
    }
  }
  const double limit = std::isfinite(unstable) && !reached() ? all.front().ratio : 0;
  all = reached() ? std::vector<RatioSample>{all[0], all[1]} : pieces(counted, {all.front(), range.smallest});
  FoundRatio found = find_in_pieces(sample, all, wanted, tolerance);
  if (!found.reached) {
    found.at = *std::min_element(all.begin(), all.end(), [](const RatioSample& a, const RatioSample& b) {
      return a.shear_to_bulk < b.shear_to_bulk;
    });
  }
  found.limit = limit;
  found.steps += count;
  return found;
}

}  // namespace equidem
