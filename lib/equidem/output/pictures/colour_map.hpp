// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Colours of numbers: two maps of even perceptual steps, the range they span, and the ticks of their bar.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace equidem {

/// sRGB, each component in [0, 1].
struct Colour {
  double red = 0;
  double green = 0;
  double blue = 0;
};

enum class ColourMap {
  diverging,   ///< blue (0) over near-white (0.5) to vermilion (1), for numbers of both signs
  sequential,  ///< pale yellow (0) over green to dark blue (1), for numbers of one sign
};

/// The colour at t, clamped to [0, 1]; grey where t is NaN. Both maps run along straight pieces in Oklab (Ottosson
/// 2020) with linear lightness, so that equal steps of the number look equal.
Colour colour_at(ColourMap map, double t);

/// Range of the numbers shown by colours.
struct ColourScale {
  ColourMap map = ColourMap::sequential;
  double low = 0;  ///< the number at t = 0; with the sequential map of negative numbers the larger one
  double high = 1;
  bool clipped_below = false;  ///< some numbers lie outside: the bar ends in a point
  bool clipped_above = false;

  [[nodiscard]] Colour colour_of(double value) const { return colour_at(map, (value - low) / (high - low)); }
};

/// A scale for given numbers, NaN left aside: [-m, m] and diverging where both signs matter, else sequential, dark
/// for the largest magnitude. Single extremes do not set the range: it covers the middle 99 % where the whole is more
/// than 1.5 times as wide. Numbers that differ by less than 1e-6 of their size count as equal, so that rounding is
/// never shown as a pattern.
ColourScale colour_scale(std::span<const double> values);

/// Multiples of a step 1, 2 or 5 times a power of ten within [low, high], about `wanted` of them; low <= high.
std::vector<double> nice_ticks(double low, double high, int wanted = 5);

/// The longest of 1, 2 or 5 times a power of ten that is no longer than wanted; wanted > 0.
double scale_bar_length(double wanted);

/// A factor of a unit and its prefix: {1e-6, "M"} for numbers of some million.
struct UnitPrefix {
  double factor = 1;
  std::string prefix;
};
UnitPrefix unit_prefix(double largest);

}  // namespace equidem
