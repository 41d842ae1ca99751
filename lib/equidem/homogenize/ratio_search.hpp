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
  bool stable = true;        ///< false: the assembly gives way, q and slope mean nothing
};

/// Homogenizes once: one factorization.
using RatioSampler = std::function<RatioSample(double ratio)>;

/// What an assembly can show without negative springs.
struct RatioRange {
  RatioSample smallest;  ///< at r = 1e-8: what is a mechanism at r = 0 stands there
  RatioSample largest;   ///< at r = 1e6
  /// q as r -> 0+ and r -> infinity, extrapolated with the slopes: q = q_0 + q'r, and 1/q = 1/q_inf + c/r. The latter
  /// is infinite where shear is resisted by slip, as in every triangulation: G grows with kT, K stays finite.
  double at_zero = 0, at_infinity = 0;
};

RatioRange sample_range(const RatioSampler& sample);

/// Where a search ended.
struct FoundRatio {
  RatioSample at;        ///< the last sample: the answer where `reached`, else the stable one with the smallest q
  bool reached = false;  ///< q is the wanted one, to the tolerance
  int steps = 0;         ///< samples taken, those of the range not counted
  /// q rose with r at every sample: more slip resists shear more than dilation. No theorem says that it must, and
  /// where it does not, more than one ratio may give the same q.
  bool rising = true;
};

/// q(r) = wanted for r >= 0, by Newton's method with memory: inverse Hermite interpolation of the samples nearest to
/// the wanted value, x(y) with x = ln r and
///
///   y = ln((q - q_0) / (1 - q/q_inf)).
///
/// Near both ends y - x is constant, on the hexagonal lattice and for the uniform-stress estimate q = 2r/(1 + r) it is
/// constant throughout, so that the range gives a first guess that is good to a few per cent. A bracket guards it.
/// \param wanted within the range
/// \param tolerance of q, relative
/// \throws Error (computation_failed) where q(r) cannot be followed: it jumps
FoundRatio find_ratio(const RatioSampler& sample, const RatioRange& range, double wanted, double tolerance);

/// The same for r < 0, wanted < at_zero: Newton's method with memory on r(q), which starts at r = 0 and turns back
/// where the assembly is not stable. Not reached: at a thousandth of its ratio from the limit of stability.
FoundRatio find_negative_ratio(const RatioSampler& sample, const RatioRange& range, double wanted, double tolerance);

}  // namespace equidem
