// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A picture before it is drawn: positions on the page, colours, widths. Drawn once as SVG and once as PNG.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/output/pictures/canvas.hpp"
#include "equidem/output/pictures/colour_map.hpp"
#include "equidem/output/pictures/picture.hpp"

namespace equidem {

/// From metres, y up, to units of the page, y down. The page is 1000 units wide whatever its pixels, so that text and
/// lines keep their proportion.
struct PageFrame {
  static constexpr double width = 1000;
  double height = 0;
  double pixels = 1;  ///< per unit
  Vec2 corner;        ///< m, the lower left corner of the view
  Vec2 extent;        ///< m
  double scale = 1;   ///< units per metre
  Vec2 origin;        ///< units, the upper left corner of the drawing
  Vec2 room;          ///< units, of the area in whose middle it stands

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
/// \param pixels per unit
PageFrame lay_out_page(const Bounds& bounds, bool titled, double right, double shortest, double pixels);

struct PictureScene {
  const AssemblyState& state;
  const PictureOptions& options;
  PageFrame frame = {};
  std::vector<Vec2> centres = {};  ///< m, displaced
  double displacement_scale = 1;

  std::vector<double> values = {};  ///< per disc, in shown units; empty: not coloured
  ColourScale colours = {};         ///< of the values
  std::string colour_label = {};    ///< "mean stress"
  std::string colour_unit = {};     ///< "(MPa)"

  Vec2 middle = {};          ///< m, of the displaced centres
  double longest_arrow = 0;  ///< m

  bool as_image = false;      ///< more than most_drawn_discs
  bool force_chains = false;  ///< asked for, known and not too fine
  double widest_force = 0;    ///< N/m, |normal force| of the widest line; stronger ones are as wide
  double widest_line = 0;     ///< units
  std::string caption = {};
};

/// Everything that is decided before drawing.
/// \throws Error (bad_input) as write_picture does
PictureScene plan_scene(const AssemblyState& state, const PictureOptions& options);

/// Whether a load points away from the middle of the assembly: its arrow then starts at the disc, else it ends there.
inline bool pulls(const PictureScene& scene, const DrawnLoad& load) {
  return dot(load.force, scene.centres[load.disc] - scene.middle) >= 0;
}

void draw_discs(Canvas& canvas, const PictureScene& scene);
void draw_force_chains(Canvas& canvas, const PictureScene& scene);
void draw_cracks(Canvas& canvas, const PictureScene& scene);
void draw_supports_and_loads(Canvas& canvas, const PictureScene& scene);
void draw_gauges(Canvas& canvas, const PictureScene& scene);

/// The colours of a scale from its low end, below, to its high end, with ticks to the right.
void draw_colour_bar(Canvas& canvas, const ColourScale& scale, Vec2 corner, double width, double length);
/// Title, colour bar, scale bar, legend of the force chains, caption.
void draw_legends(Canvas& canvas, const PictureScene& scene);
/// Title and caption of any picture, and its scale bar.
void draw_texts(Canvas& canvas, const PageFrame& frame, const std::string& title, const std::string& caption);

inline constexpr double page_margin = 40;  // units, to the left of all and, without a colour bar, to the right
inline constexpr Colour tension_colour{0.45, 0.02, 0.02};
inline constexpr Colour compression_colour{0.02, 0.10, 0.33};
inline constexpr Colour ink{0.13, 0.13, 0.13}, grey{0.42, 0.42, 0.42};

}  // namespace equidem
