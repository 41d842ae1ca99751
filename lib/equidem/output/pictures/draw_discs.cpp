// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "equidem/output/pictures/scene.hpp"

namespace equidem {
namespace {

constexpr Colour uncoloured{0.84, 0.86, 0.88};
constexpr Colour disc_outline{0.45, 0.45, 0.45};
constexpr Colour rest_outline{0.72, 0.72, 0.72};
constexpr double smallest_outlined = 5;  // pixels, radius
constexpr double finest_image = 2500;    // image pixels across; below, two per pixel of the page
/// On the hexagonal lattice every point is within 2/sqrt3 radii of a centre.
constexpr double cell_reach = 1.1547005383792517;
constexpr double irregular_reach = 1.35;  // of the radius of a circle as large as the cell
constexpr double too_small_to_see = 0.6;  // image pixels, radius: below it a pixel takes the mean of its discs

Colour colour_of(const PictureScene& scene, std::size_t disc) {
  return scene.values.empty() ? uncoloured : scene.colours.colour_of(scene.values[disc]);
}

/// Reach of a disc's cell from its centre, m.
double reach_of(const Assembly& assembly, std::size_t disc) {
  double reach = cell_reach * assembly.radii[disc];
  if (!assembly.cell_areas.empty()) {
    const double as_circle = std::sqrt(std::max(assembly.cell_areas[disc], 0.0) / std::numbers::pi);
    reach = std::max(reach, std::min(irregular_reach * as_circle, 2.5 * assembly.radii[disc]));
  }
  return reach;
}

/// Each pixel shows the disc with the smallest power distance d² - r²; where discs are smaller than pixels, the mean
/// of those in it.
Raster paint_cells(const PictureScene& scene, double per_unit) {
  const PageFrame& frame = scene.frame;
  const Assembly& assembly = scene.state.assembly;
  const double scale = frame.scale * per_unit;
  const int width = std::max(1, static_cast<int>(std::ceil(frame.extent.x * scale)));
  const int height = std::max(1, static_cast<int>(std::ceil(frame.extent.y * scale)));
  Raster raster(width, height);
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<float> nearest(pixels, std::numeric_limits<float>::infinity());
  std::vector<std::int32_t> owner(pixels, -1);
  std::vector<float> red(pixels, 0), green(pixels, 0), blue(pixels, 0), count(pixels, 0);

  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    const double x = (scene.centres[disc].x - frame.corner.x) * scale;
    const double y = (frame.corner.y + frame.extent.y - scene.centres[disc].y) * scale;
    const double radius = assembly.radii[disc] * scale;
    if (radius < too_small_to_see) {
      const auto at =
          static_cast<std::size_t>(std::clamp(static_cast<int>(y), 0, height - 1)) * static_cast<std::size_t>(width) +
          static_cast<std::size_t>(std::clamp(static_cast<int>(x), 0, width - 1));
      const Colour colour = colour_of(scene, disc);
      red[at] += static_cast<float>(colour.red);
      green[at] += static_cast<float>(colour.green);
      blue[at] += static_cast<float>(colour.blue);
      count[at] += 1;
      continue;
    }
    const double reach = reach_of(assembly, disc) * scale;
    const int left = std::max(0, static_cast<int>(x - reach));
    const int right = std::min(width - 1, static_cast<int>(x + reach));
    const int top = std::max(0, static_cast<int>(y - reach));
    const int bottom = std::min(height - 1, static_cast<int>(y + reach));
    for (int row = top; row <= bottom; ++row) {
      for (int column = left; column <= right; ++column) {
        const double dx = column + 0.5 - x, dy = row + 0.5 - y;
        const double squared = dx * dx + dy * dy;
        if (squared > reach * reach) continue;
        const auto at =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
        const auto power = static_cast<float>(squared - radius * radius);
        if (power < nearest[at]) {
          nearest[at] = power;
          owner[at] = static_cast<std::int32_t>(disc);
        }
      }
    }
  }
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const auto at =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
      if (owner[at] >= 0) {
        raster.set(column, row, colour_of(scene, static_cast<std::size_t>(owner[at])));
      } else if (count[at] > 0) {
        raster.set(column, row, {red[at] / count[at], green[at] / count[at], blue[at] / count[at]});
      }
    }
  }
  return raster;
}

}  // namespace

void draw_discs(Canvas& canvas, const PictureScene& scene) {
  const PageFrame& frame = scene.frame;
  const Assembly& assembly = scene.state.assembly;
  if (scene.as_image) {
    const double per_unit = std::max(frame.pixels, std::min(2 * frame.pixels, finest_image / PageFrame::width));
    const Raster raster = paint_cells(scene, per_unit);
    canvas.image(raster, frame.origin, raster.width / per_unit, raster.height / per_unit);
    return;
  }
  if (scene.options.undeformed && !scene.state.motions.empty()) {
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
      canvas.stroke_circle(frame.to_page(assembly.centres[disc]), assembly.radii[disc] * frame.scale, 0.7,
                           rest_outline);
    }
  }
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    const double radius = assembly.radii[disc] * frame.scale;
    const Vec2 centre = frame.to_page(scene.centres[disc]);
    canvas.fill_circle(centre, radius, colour_of(scene, disc));
    if (radius * frame.pixels >= smallest_outlined) canvas.stroke_circle(centre, radius - 0.3, 0.6, disc_outline);
  }
}

}  // namespace equidem
