// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A page to draw on, in pixels from its upper left corner, x to the right and y down: PNG or SVG, made in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/output/pictures/colour_map.hpp"

namespace equidem {

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

/// \throws Error (bad_input) on a file that is no PNG
Raster read_png(const std::filesystem::path& path);

class Canvas {
 public:
  /// A white page.
  /// \param width, height in pixels
  /// \param unit pixels per unit of everything that is drawn
  /// \throws Error (computation_failed) where memory does not suffice
  Canvas(PageFormat format, int width, int height, double unit);
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

  /// \param at the anchor on the base line; the text is UTF-8, other bytes are shown as '?'
  void text(const std::string& text, Vec2 at, double size, TextAnchor anchor, const Colour& colour, bool bold = false);
  [[nodiscard]] double text_width(const std::string& text, double size, bool bold = false);

  /// End the page.
  /// \return the bytes of the file
  /// \throws Error (computation_failed) with the reason
  [[nodiscard]] std::string finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace equidem
