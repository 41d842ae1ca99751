// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <tuple>

#include "equidem/core/text.hpp"
#include "equidem/output/pictures/scene.hpp"

namespace equidem {
namespace {

constexpr Colour load_colour{0.0, 0.45, 0.32};
constexpr double text_size = 14, small_text = 12.5, title_size = 18;

/// "12.3 kN/m".
std::string with_unit(double value, const std::string& unit) {
  const UnitPrefix prefix = unit_prefix(std::abs(value));
  return fmt::format("{:.3g} {}{}", value * prefix.factor, prefix.prefix, unit);
}

/// The minus sign of typography.
std::string tick_text(double value) {
  const std::string text = fmt::format("{:.6g}", std::abs(value) < 1e-12 ? 0.0 : value);
  return text.front() == '-' ? "−" + text.substr(1) : text;
}

/// Beside the drawing area, its label above.
void draw_colours(Canvas& canvas, const PictureScene& scene) {
  const PageFrame& frame = scene.frame;
  constexpr double width = 18, tip = 14;
  const double area_top = frame.origin.y + 0.5 * (frame.scale * frame.extent.y - frame.room.y);
  const double length = std::min(frame.room.y - 2 * tip - 50, 420.0);
  const double left = frame.width - 92.0;
  const double top = area_top + 0.5 * (frame.room.y - length) + 20;
  draw_colour_bar(canvas, scene.colours, {left, top}, width, length);
  canvas.text(scene.colour_label, {left, top - tip - 27}, small_text, TextAnchor::left, ink);
  canvas.text(scene.colour_unit, {left, top - tip - 11}, small_text, TextAnchor::left, ink);
}

void draw_scale_bar(Canvas& canvas, const PageFrame& frame, double left, double y) {
  const double length = scale_bar_length(0.2 * frame.room.x / frame.scale);  // m
  const double right = left + length * frame.scale;
  canvas.line({left, y}, {right, y}, 1.4, ink);
  for (const double x : {left, right}) canvas.line({x, y - 5}, {x, y + 5}, 1.4, ink);
  canvas.text(with_unit(length, "m"), {0.5 * (left + right), y - 9}, small_text, TextAnchor::centre, ink);
}

void draw_arrow(Canvas& canvas, Vec2 tail, Vec2 tip) {
  const Vec2 along = tip - tail;
  const double length = norm(along);
  if (length < 1) return;
  const Vec2 direction = along / length;
  const double head = std::min(9.0, 0.6 * length);
  const Vec2 back = tip - head * direction;
  const Vec2 side = 0.38 * head * perpendicular(direction);
  canvas.line(tail, back, std::clamp(length / 30, 1.2, 2.2), load_colour);
  canvas.fill_polygon({tip, back + side, back - side}, load_colour);
}

/// The triangle points at the disc from below, or from the left where only x is held.
void draw_support(Canvas& canvas, Vec2 centre, double radius, const DrawnSupport& support) {
  const double size = std::clamp(1.1 * radius, 5.0, 16.0);
  const Vec2 out = support.y ? Vec2{0, 1} : Vec2{-1, 0};
  const Vec2 side = perpendicular(out);
  const Vec2 tip = centre + radius * out;
  const Vec2 base = tip + size * out;
  const std::vector<Vec2> triangle{tip, base + 0.6 * size * side, base - 0.6 * size * side};
  if (support.x && support.y) {
    canvas.fill_polygon(triangle, grey);
  } else {
    canvas.fill_polygon(triangle, {1, 1, 1});
    canvas.stroke_polygon(triangle, 1, grey);
    const Vec2 floor = base + 0.22 * size * out;
    canvas.line(floor + 0.7 * size * side, floor - 0.7 * size * side, 1.2, grey);
  }
}

}  // namespace

void draw_colour_bar(Canvas& canvas, const ColourScale& scale, Vec2 corner, double width, double length) {
  const double low = std::min(scale.low, scale.high), high = std::max(scale.low, scale.high);
  const double left = corner.x, right = left + width, top = corner.y, bottom = top + length, tip = 0.8 * width;
  constexpr int per_unit = 4;  // image pixels, so that the blur of its edge hides under the frame
  Raster gradient(static_cast<int>(per_unit * width), static_cast<int>(std::lround(per_unit * length)));
  for (int row = 0; row < gradient.height; ++row) {
    const Colour colour = scale.colour_of(high - (high - low) * (row + 0.5) / gradient.height);
    for (int column = 0; column < gradient.width; ++column) gradient.set(column, row, colour);
  }
  canvas.image(gradient, corner, width, length);
  const double centre = left + 0.5 * width;
  if (scale.clipped_above) canvas.fill_polygon({{left, top}, {right, top}, {centre, top - tip}}, scale.colour_of(high));
  if (scale.clipped_below)
    canvas.fill_polygon({{left, bottom}, {right, bottom}, {centre, bottom + tip}}, scale.colour_of(low));
  canvas.stroke_polygon({{left, top}, {right, top}, {right, bottom}, {left, bottom}}, 0.7, grey);
  for (const double tick : nice_ticks(low, high)) {
    const double y = top + length * (high - tick) / (high - low);
    canvas.line({right, y}, {right + 5, y}, 0.8, grey);
    canvas.text(tick_text(tick), {right + 9, y + 0.36 * small_text}, small_text, TextAnchor::left, ink);
  }
}

void draw_supports_and_loads(Canvas& canvas, const PictureScene& scene) {
  const PageFrame& frame = scene.frame;
  const Assembly& assembly = scene.state.assembly;
  for (const DrawnSupport& support : scene.options.supports) {
    if (!support.x && !support.y) continue;
    draw_support(canvas, frame.to_page(scene.centres[support.disc]), assembly.radii[support.disc] * frame.scale,
                 support);
  }
  double largest = 0;
  for (const DrawnLoad& load : scene.options.loads) largest = std::max(largest, norm(load.force));
  if (!(largest > 0) || !std::isfinite(largest)) return;
  const double longest = scene.longest_arrow * frame.scale;  // units
  for (const DrawnLoad& load : scene.options.loads) {
    const double size = norm(load.force);
    if (size == 0) continue;
    const Vec2 direction = Vec2{load.force.x, -load.force.y} / size;
    const Vec2 centre = frame.to_page(scene.centres[load.disc]);
    const Vec2 edge = assembly.radii[load.disc] * frame.scale * direction;
    const Vec2 arrow = longest * size / largest * direction;
    if (pulls(scene, load)) {
      draw_arrow(canvas, centre + edge, centre + edge + arrow);
    } else {
      draw_arrow(canvas, centre - edge - arrow, centre - edge);
    }
  }
}

void draw_gauges(Canvas& canvas, const PictureScene& scene) {
  constexpr Colour white{1, 1, 1};
  constexpr double dot_radius = 4.5, halo = 2, label_distance = 15;
  for (const DrawnGauge& gauge : scene.options.gauges) {
    const Vec2 from = scene.frame.to_page(scene.centres[gauge.first]),
               to = scene.frame.to_page(scene.centres[gauge.second]);
    if (from == to) continue;
    const Vec2 direction = (to - from) / norm(to - from);
    canvas.line(from, to, 1.6 + 2 * halo, white);
    canvas.line(from, to, 1.6, ink);
    for (const auto& [at, outwards, label] :
         {std::tuple{from, -1.0, gauge.first_label}, {to, 1.0, gauge.second_label}}) {
      canvas.fill_circle(at, dot_radius + halo, white);
      canvas.fill_circle(at, dot_radius, ink);
      const Vec2 base = at + outwards * label_distance * direction + Vec2{0, 0.35 * small_text};
      canvas.fill_circle(base - Vec2{0, 0.35 * small_text}, 0.62 * small_text, white);
      canvas.text(label, base, small_text, TextAnchor::centre, ink, true);
    }
  }
}

void draw_texts(Canvas& canvas, const PageFrame& frame, const std::string& title, const std::string& caption) {
  if (!title.empty()) canvas.text(title, {page_margin, 38}, title_size, TextAnchor::left, ink, true);
  draw_scale_bar(canvas, frame, page_margin, frame.height - 50.0);
  canvas.text(caption, {page_margin, frame.height - 18.0}, small_text, TextAnchor::left, grey);
}

void draw_legends(Canvas& canvas, const PictureScene& scene) {
  const PageFrame& frame = scene.frame;
  if (!scene.values.empty()) draw_colours(canvas, scene);
  if (scene.force_chains)
    canvas.text("red: tension, blue: compression; widest line " + with_unit(scene.widest_force, "N/m"),
                {page_margin + frame.room.x, frame.height - 46.0}, small_text, TextAnchor::right, ink);
  draw_texts(canvas, frame, scene.options.title, scene.caption);
}

}  // namespace equidem
