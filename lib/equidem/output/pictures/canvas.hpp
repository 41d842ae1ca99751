// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A page on which figures are drawn by cairo, and its colours.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/vector.hpp"

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

enum class PageFormat { png, svg };
enum class TextAnchor { left, centre, right };

/// An image of its own resolution: 32-bit numbers 0xAARRGGBB in the byte order of the machine, row by row from the
/// top; transparent until set.
struct Raster {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> bytes;

  Raster(int w, int h) : width(w), height(h), bytes(4 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  void set(int x, int y, const Colour& colour);
};

class Canvas {
 public:
  /// A white page.
  /// \param height units; a unit is a pixel of the PNG
  /// \throws Error (computation_failed) where memory does not suffice
  Canvas(PageFormat format, double height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void fill_circle(Vec2 centre, double radius, const Colour& colour);
  void stroke_circle(Vec2 centre, double radius, double width, const Colour& colour);
  /// \param half_axes the first along `angle`, rad, from x to y (clockwise on the page)
  void fill_ellipse(Vec2 centre, Vec2 half_axes, double angle, const Colour& colour);
  void stroke_ellipse(Vec2 centre, Vec2 half_axes, double angle, double width, const Colour& colour);
  /// With round ends.
  void line(Vec2 from, Vec2 to, double width, const Colour& colour);
  void fill_polygon(const std::vector<Vec2>& corners, const Colour& colour);
  void stroke_polygon(const std::vector<Vec2>& corners, double width, const Colour& colour);
  void image(const Raster& raster, Vec2 upper_left, double width, double height);

  /// \param at the anchor on the base line; the text is UTF-8 without control characters
  void text(const std::string& text, Vec2 at, double size, TextAnchor anchor, const Colour& colour, bool bold = false);

  /// End the page.
  /// \return the bytes of the file
  /// \throws Error (computation_failed) with the reason
  [[nodiscard]] std::string finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// From metres, y up, to units of the page, y down. A unit is a pixel of the PNG.
struct PageFrame {
  double height = 0;
  Vec2 corner;       ///< m, the lower left corner of the view
  Vec2 extent;       ///< m
  double scale = 1;  ///< units per metre
  Vec2 origin;       ///< units, the upper left corner of the drawing
  Vec2 room;         ///< units, of the area in whose middle it stands

  [[nodiscard]] Vec2 to_page(Vec2 p) const {
    return {origin.x + (p.x - corner.x) * scale, origin.y + (corner.y + extent.y - p.y) * scale};
  }
};

/// The smallest rectangle round circles, m.
struct Bounds {
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};

  void include(Vec2 centre, double radius);
  [[nodiscard]] double larger_side() const { return std::max(high.x - low.x, high.y - low.y); }
};

/// A page with room for a title, a scale bar and a caption.
/// \param right width that stays free to the right, units
/// \param shortest height of the drawing area, units, at least
PageFrame lay_out_page(const Bounds& bounds, bool titled, double right, double shortest);

/// The colours of a scale from its low end, below, to its high end, with ticks to the right.
void draw_colour_bar(Canvas& canvas, const ColourScale& scale, Vec2 corner, double width, double length);
/// Title and caption of any picture, and its scale bar.
void draw_texts(Canvas& canvas, const PageFrame& frame, const std::string& title, const std::string& caption);

/// Above this many discs they are drawn as an image in which each point has the colour of the nearest disc, in the SVG
/// too, and outlines and force chains, too fine to be seen, are omitted (stated in the caption).
inline constexpr std::size_t most_drawn_discs = 10000;

/// "12.3 kN/m".
std::string with_unit(double value, const std::string& unit);

inline constexpr double page_width = 1000;  // units
inline constexpr double small_text = 12.5;  // units
inline constexpr double page_margin = 40;   // units, to the left of all and, without a colour bar, to the right
inline constexpr Colour ink{0.13, 0.13, 0.13}, grey{0.42, 0.42, 0.42};

}  // namespace equidem
