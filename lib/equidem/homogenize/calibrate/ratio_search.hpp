// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The ratio r = kT/kN at which an assembly has a wanted q = G/K, from few samples of q and dq/dr.
#pragma once

#include <functional>

namespace equidem {

/// G/K of an assembly at one ratio kT/kN.
struct RatioSample {
  double ratio = 0;          ///< r = kT/kN
  double shear_to_bulk = 0;  ///< q = G/K
  double slope = 0;          ///< dq/dr
  double bulk_growth = 0;    ///< d ln K / d ln r, in [0, 1]: 1 where K is that of the tangential springs alone
  bool stable = true;        ///< false: the assembly is unstable, the other numbers have no meaning
};

/// Homogenizes once: one factorization.
using RatioSampler = std::function<RatioSample(double ratio)>;

/// The range of q that an assembly can show without negative springs, r <= 1e6.
struct RatioRange {
  RatioSample smallest;  ///< at r = 1e-8, or where that is lost in rounding at the next that is not
  RatioSample largest;   ///< at r = 1e6, or likewise
  /// q as r -> 0+ and r -> infinity, extrapolated with the slopes: q = q_0 + q'r, and 1/q = 1/q_inf + c/r. The latter
  /// is infinite where shear is resisted by slip, as in every triangulation: G grows with kT, K stays finite.
  double at_zero = 0, at_infinity = 0;
  bool closed = true;              ///< r = 0 can be had; false: G or K is lost there
  double least = 0, greatest = 0;  ///< q of both ends; after find_by_scan its extremes in between, too
  /// q rises at both ends, and from one to the other. No theorem requires it: sparse networks have K grow faster
  /// than G in some decades.
  bool rising = true;
};

/// Two samples, more only where those at the ends are lost in rounding. Neither is stable where none could be had.
RatioRange sample_range(const RatioSampler& sample);

/// Result of a search.
struct FoundRatio {
  RatioSample at;        ///< the last sample, where `reached`
  bool reached = false;  ///< q is the wanted one, to the tolerance
  int steps = 0;         ///< samples taken, those of the range not counted
  bool rising = true;    ///< q rose with r at every sample; else more than one ratio may give the same q
  double limit = 0;      ///< of find_negative_ratio, where known: within 5e-5 of the limit of stability
};

/// q(r) = wanted for r >= 0: decades from r = 1 towards `wanted` until it is passed, then the zero of q - wanted over
/// ln r by the method of Alefeld, Potra & Shi (1995), which is TOMS 748.
/// \param range rising
/// \param wanted from range.at_zero to range.greatest
/// \param tolerance of q, relative
/// \return not reached where the assembly is unstable on the way, or at r = 0 where that is wanted
/// \throws Error (computation_failed) where q(r) cannot be followed: it jumps
FoundRatio find_ratio(const RatioSampler& sample, const RatioRange& range, double wanted, double tolerance);

/// As find_ratio, for any range: one sample per decade, closed in on every extremum (to 1e-9 of q), then as find_ratio
/// in the piece with `wanted` that is nearest to r = 1. C is the least of energies linear in r, so that K and G are
/// sums of r/(r + t) with positive weights: they, and q, bend over no less than a decade.
/// \param range its extremes are set
/// \return not reached where `wanted` lies outside of them
FoundRatio find_by_scan(const RatioSampler& sample, RatioRange& range, double wanted, double tolerance);

/// As find_ratio, for r < 0, wanted < at_zero: down from r = 0 by bisection to the limit of stability or the first q
/// below `wanted`, then as find_by_scan. Not reached: `at` is the sample with the smallest q of all between the limit
/// and r = 0, the same for every `wanted`; at.ratio > 0 where nothing negative is stable. \param range closed
FoundRatio find_negative_ratio(const RatioSampler& sample, const RatioRange& range, double wanted, double tolerance);

}  // namespace equidem
