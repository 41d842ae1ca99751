// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Periods in a history, and the period at which a tank sloshes.
#pragma once

#include <span>
#include <vector>

namespace equidem {

/// The strongest harmonic part of a history.
struct SpectralPeak {
  double frequency = 0;   ///< Hz
  double amplitude = 0;   ///< in the unit of the history
  double resolution = 0;  ///< Hz, 2/T: parts nearer to each other than that are seen as one
  [[nodiscard]] double period() const { return 1 / frequency; }
};

/// Amplitudes of harmonic parts: at each frequency the c cos + s sin that, with a constant and a trend, fits the
/// history best, its moments weighted by Hann's window. Unlike in a Fourier sum slow parts, of one or two periods in
/// all, are not mixed with their mirror image and the mean. \param times s, ascending; need not be equally spaced
/// \param frequencies Hz, > 0
std::vector<double> amplitude_spectrum(std::span<const double> times, std::span<const double> values,
                                       std::span<const double> frequencies);

/// The harmonic part between two frequencies that explains most of the history (the least squares of
/// amplitude_spectrum); one that stands at a bound is the flank of another outside.
/// \param lowest, highest Hz; the lowest is at least 1.5/T, the highest at most half the sampling rate
/// \throws Error (bad_input) on fewer than 8 moments, or no frequency between the bounds; (computation_failed) where
///         the most lies at a bound, or the history is constant
SpectralPeak spectral_peak(std::span<const double> times, std::span<const double> values, double lowest,
                           double highest);

/// First period of the free surface in a rectangular tank, linear theory: T = 2 pi/sqrt(pi g/l tanh(pi h/l)) (Lamb,
/// Hydrodynamics, art. 257; Sukegawa 2010 (7.2) prints 2 pi h/l).
/// \param width l, depth h in m; gravity g in m/s²; all > 0
double sloshing_period(double width, double depth, double gravity);

}  // namespace equidem
