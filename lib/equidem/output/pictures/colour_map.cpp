// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/colour_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

namespace equidem {
namespace {

/// Oklab: lightness L and the opponent axes a (green to red) and b (blue to yellow); Ottosson 2020.
struct Oklab {
  double L = 0, a = 0, b = 0;
};

double to_srgb(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

Colour to_colour(const Oklab& c) {
  const double l = std::pow(c.L + 0.3963377774 * c.a + 0.2158037573 * c.b, 3);
  const double m = std::pow(c.L - 0.1055613458 * c.a - 0.0638541728 * c.b, 3);
  const double s = std::pow(c.L - 0.0894841775 * c.a - 1.2914855480 * c.b, 3);
  return {to_srgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          to_srgb(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          to_srgb(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

Oklab at_hue(double L, double chroma, double degrees) {
  const double h = degrees * std::numbers::pi / 180;
  return {L, chroma * std::cos(h), chroma * std::sin(h)};
}

/// Linear pieces through equally spaced control points.
template <std::size_t n>
Oklab along(const std::array<Oklab, n>& points, double t) {
  const double position = t * static_cast<double>(n - 1);
  const std::size_t piece = std::min(static_cast<std::size_t>(position), n - 2);
  const double s = position - static_cast<double>(piece);
  const Oklab& p = points[piece];
  const Oklab& q = points[piece + 1];
  return {p.L + s * (q.L - p.L), p.a + s * (q.a - p.a), p.b + s * (q.b - p.b)};
}

/// The value below which the given share of sorted numbers lies.
double quantile(std::vector<double>& values, double share) {
  const auto index = static_cast<std::size_t>(std::llround(share * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
  return values[index];
}

constexpr double equal_within = 1e-6;   // of the size of the numbers
constexpr double minor_sign = 0.1;      // of the larger magnitude: less is not worth half a map
constexpr double outlier_spread = 1.5;  // whole range over the range of the middle 99 %

}  // namespace

Colour colour_at(ColourMap map, double t) {
  if (std::isnan(t)) return {0.7, 0.7, 0.7};
  static const std::array<Oklab, 3> diverging = {at_hue(0.50, 0.13, 252), at_hue(0.965, 0.004, 100),
                                                 at_hue(0.50, 0.15, 36)};
  static const std::array<Oklab, 4> sequential = {at_hue(0.955, 0.060, 104), at_hue(0.80, 0.115, 155),
                                                  at_hue(0.645, 0.105, 225), at_hue(0.49, 0.130, 272)};
  t = std::clamp(t, 0.0, 1.0);
  return to_colour(map == ColourMap::diverging ? along(diverging, t) : along(sequential, t));
}

ColourScale colour_scale(std::span<const double> values) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  if (finite.empty()) return {};
  const auto [least, most] = std::minmax_element(finite.begin(), finite.end());
  const double smallest = *least, largest = *most;
  double low = quantile(finite, 0.005), high = quantile(finite, 0.995);
  if (largest - smallest <= outlier_spread * (high - low)) low = smallest, high = largest;

  const double size = std::max(std::abs(low), std::abs(high));
  ColourScale scale;
  if (size == 0) return scale;
  const bool equal = high - low <= equal_within * size;
  if (low < 0 && high > 0 && std::min(-low, high) > minor_sign * size) {
    scale = {ColourMap::diverging, -size, size, false, false};
  } else if (equal) {
    scale = {ColourMap::sequential, 0, low + high, false, false};  // the common value in the middle of the map
  } else if (high > -low) {
    scale = {ColourMap::sequential, low, high, false, false};
  } else {
    scale = {ColourMap::sequential, high, low, false, false};
  }
  const double slack = 1e-9 * size;
  scale.clipped_below = smallest < std::min(scale.low, scale.high) - slack && !equal;
  scale.clipped_above = largest > std::max(scale.low, scale.high) + slack && !equal;
  return scale;
}

std::vector<double> nice_ticks(double low, double high, int wanted) {
  if (!(low < high)) return {low};
  const double raw = (high - low) / std::max(wanted, 1);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double lead = raw / power;
  const double step = power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
  std::vector<double> ticks;
  const double slack = 1e-9 * (high - low);
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; ++k) ticks.push_back(k * step);
  return ticks;
}

double scale_bar_length(double wanted) {
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double lead = wanted / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

UnitPrefix unit_prefix(double largest) {
  static const UnitPrefix prefixes[] = {{1e9, "n"},  {1e6, "µ"},  {1e3, "m"},  {1, ""},
                                        {1e-3, "k"}, {1e-6, "M"}, {1e-9, "G"}, {1e-12, "T"}};
  if (!(largest > 0) || !std::isfinite(largest)) return {};
  for (const UnitPrefix& prefix : prefixes) {
    if (largest * prefix.factor < 1000) return prefix;
  }
  return prefixes[7];
}

}  // namespace equidem
