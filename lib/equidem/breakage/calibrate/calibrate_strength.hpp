// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Wanted strengths of a material -> strengths and friction of its contacts.
///
/// If all strengths of contacts are multiplied by s, all loads at which contacts break are multiplied by s, and their
/// order stays. With f_t = 1 the strengths of a sample in tension T and in a second test S therefore depend on f_s/f_t
/// and mu alone; the ratio S/T decides one of these two, and f_t follows as wanted T over computed T:
///
///   (mean of S)/(mean of T) = wanted ratio,   f_t = wanted tension/(mean of T),
///
/// means over samples. The unknown x = f_s/f_t, or mu, is found in x/(1 + x) by regula falsi (Illinois) between its
/// ends.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "equidem/breakage/calibrate/strength_test.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/statistics.hpp"

namespace equidem {

/// The strengths wanted; compressive or toughness.
struct StrengthTargets {
  double tensile = 0;                      ///< Pa
  std::optional<double> compressive = {};  ///< Pa, unconfined; or
  std::optional<double> toughness = {};    ///< Pa sqrt(m), mode I; the mean over notches
  std::vector<double> notches = {};        ///< m, lengths 2a; with toughness

  /// The second strength, Pa or Pa sqrt(m).
  [[nodiscard]] double second() const { return compressive ? *compressive : *toughness; }
};

struct StrengthCalibrationOptions {
  /// Friction, bond length and Weibull modulus; tension and shear are found, each sample has a seed of its own.
  StrengthOptions strengths = {};
  std::optional<double> shear_over_tension =
      {};                   ///< f_s/f_t: the friction is found; none: f_s is, with the friction given
  double accuracy = 0.005;  ///< of the ratio of the two strengths, relative
};

/// One sample with its seeds.
struct SeededSample {
  StrengthSample sample;
  std::uint64_t seed = 1;  ///< of the strengths
};

/// Strengths of one sample with the contacts that were found.
struct TestedSample {
  std::uint64_t seed = 1;
  double tensile = 0;  ///< Pa
  double second = 0;   ///< Pa, or Pa sqrt(m) of a toughness
  std::int64_t events = 0, in_shear = 0;
};

/// A value of f_s/f_t or of the friction, with the ratio of the mean strengths there.
struct TriedValue {
  double value = 0, ratio = 0;  ///< an infinite ratio: the load of some sample never falls
};

struct StrengthCalibration {
  /// As in StrengthOptions: N/m, or Pa with a bond length.
  double tension = 0, shear = 0;
  double friction = 0;
  /// Standard errors from the scatter over samples, to first order; NaN: there is one sample, or the ratio does not
  /// depend on what is found.
  double tension_error = 0, shear_error = 0, friction_error = 0;
  MeanEstimate tensile, second;  ///< over the samples
  /// Second over tensile of the means: the wanted one to the accuracy asked for, or, where it jumps over that, the
  /// nearest value that was found.
  double ratio = 0;
  std::vector<TestedSample> samples;
  std::vector<TriedValue> tried;  ///< ascending
  std::int64_t tests = 0;
  double energy_error = 0;  ///< the largest of all tests

  /// The least and largest ratio of all values that were tried, Pa/Pa or sqrt(m).
  [[nodiscard]] double lowest_ratio() const;
  [[nodiscard]] double highest_ratio() const;
};

/// The ratio wanted lies outside the range that the samples have: the strengths at the nearest one are found.
class InfeasibleStrengths : public ErrorWith<StrengthCalibration> {
 public:
  using ErrorWith::ErrorWith;
};

/// The least and largest values that are tried.
inline constexpr double least_shear_over_tension = 0.05, largest_shear_over_tension = 1e6, most_friction = 10;

/// \param progress called with an estimate of the share that is done; may be empty
/// \throws Error (bad_input) where targets or options are out of range; InfeasibleStrengths where the ratio lies
///         outside the feasible range, which the sentence states; as StrengthSample::strength, but
///         ErrorWith<StrengthCalibration> with the strengths at the nearest ratio where some were tried
StrengthCalibration calibrate_strength(const std::vector<SeededSample>& samples, const StrengthTargets& wanted,
                                       const StrengthCalibrationOptions& options,
                                       const std::function<void(double)>& progress = {});

}  // namespace equidem
