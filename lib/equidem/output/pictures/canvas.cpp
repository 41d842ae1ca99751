// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

#include <cairo-svg.h>
#include <cairo.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

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

namespace {

cairo_status_t append_bytes(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

/// cairo numbers images and surfaces of an SVG by a counter of the whole process ("image177"): numbered anew in order
/// of appearance, the same drawing gives the same bytes.
std::string number_anew(const std::string& svg) {
  std::map<std::string, std::size_t> numbers;
  std::string result;
  result.reserve(svg.size());
  std::size_t copied = 0;
  for (std::size_t at = svg.find_first_of("\"#"); at != std::string::npos; at = svg.find_first_of("\"#", at + 1)) {
    const std::size_t start = at + 1;
    for (const std::string_view word : {"surface", "image"}) {
      if (svg.compare(start, word.size(), word) != 0) continue;
      const std::size_t digits = start + word.size();
      const std::size_t end = std::min(svg.find_first_not_of("0123456789", digits), svg.size());
      if (end == digits) continue;
      const auto number = numbers.emplace(svg.substr(digits, end - digits), numbers.size() + 1).first->second;
      result.append(svg, copied, digits - copied).append(std::to_string(number));
      copied = end;
    }
  }
  return result.append(svg, copied);
}

}  // namespace

void Raster::set(int x, int y, const Colour& colour) {
  std::uint8_t* pixel =
      &bytes[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
  const std::uint32_t argb = 0xff000000U | static_cast<std::uint32_t>(std::lround(255 * colour.red)) << 16 |
                             static_cast<std::uint32_t>(std::lround(255 * colour.green)) << 8 |
                             static_cast<std::uint32_t>(std::lround(255 * colour.blue));
  std::memcpy(pixel, &argb, sizeof argb);
}

struct Canvas::Implementation {
  PageFormat format;
  std::string bytes;
  cairo_surface_t* surface = nullptr;
  cairo_t* context = nullptr;

  ~Implementation() {
    cairo_destroy(context);
    cairo_surface_destroy(surface);
  }
  void source(const Colour& c) const { cairo_set_source_rgb(context, c.red, c.green, c.blue); }
  void fill(const Colour& colour) const {
    source(colour);
    cairo_fill(context);
  }
  void stroke(double width, const Colour& colour) const {
    source(colour);
    cairo_set_line_width(context, width);
    cairo_stroke(context);
  }
  void circle(Vec2 centre, double radius) const {
    cairo_new_path(context);
    cairo_arc(context, centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
    cairo_close_path(context);
  }
  void polygon(const std::vector<Vec2>& corners) const {
    for (const Vec2 corner : corners) cairo_line_to(context, corner.x, corner.y);
    cairo_close_path(context);
  }
  void ellipse(Vec2 centre, Vec2 half_axes, double angle) const {
    cairo_save(context);
    cairo_translate(context, centre.x, centre.y);
    cairo_rotate(context, angle);
    cairo_scale(context, half_axes.x, half_axes.y);
    cairo_arc(context, 0, 0, 1, 0, 2 * std::numbers::pi);
    cairo_close_path(context);
    cairo_restore(context);  // lines keep their width
  }
};

Canvas::Canvas(PageFormat format, double height)
    : implementation_(std::make_unique<Implementation>(Implementation{format, {}})) {
  constexpr int width = static_cast<int>(page_width);
  const int rows = static_cast<int>(std::ceil(height));
  Implementation& page = *implementation_;
  page.surface = format == PageFormat::png
                     ? cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, rows)
                     : cairo_svg_surface_create_for_stream(append_bytes, &page.bytes, width, rows);
  page.context = cairo_create(page.surface);
  if (cairo_status(page.context) != CAIRO_STATUS_SUCCESS) {
    computation_failed(fmt::format("a page of {} x {} pixels could not be made", width, rows),
                       cairo_status_to_string(cairo_status(page.context)), "Ask for a smaller picture");
  }
  cairo_set_source_rgb(page.context, 1, 1, 1);
  cairo_paint(page.context);
}

Canvas::~Canvas() = default;

void Canvas::fill_circle(Vec2 centre, double radius, const Colour& colour) {
  implementation_->circle(centre, radius);
  implementation_->fill(colour);
}

void Canvas::stroke_circle(Vec2 centre, double radius, double width, const Colour& colour) {
  implementation_->circle(centre, radius);
  implementation_->stroke(width, colour);
}

void Canvas::fill_ellipse(Vec2 centre, Vec2 half_axes, double angle, const Colour& colour) {
  implementation_->ellipse(centre, half_axes, angle);
  implementation_->fill(colour);
}

void Canvas::stroke_ellipse(Vec2 centre, Vec2 half_axes, double angle, double width, const Colour& colour) {
  implementation_->ellipse(centre, half_axes, angle);
  implementation_->stroke(width, colour);
}

void Canvas::line(Vec2 from, Vec2 to, double width, const Colour& colour) {
  cairo_t* context = implementation_->context;
  cairo_set_line_cap(context, CAIRO_LINE_CAP_ROUND);
  cairo_move_to(context, from.x, from.y);
  cairo_line_to(context, to.x, to.y);
  implementation_->stroke(width, colour);
}

void Canvas::fill_polygon(const std::vector<Vec2>& corners, const Colour& colour) {
  implementation_->polygon(corners);
  implementation_->fill(colour);
}

void Canvas::stroke_polygon(const std::vector<Vec2>& corners, double width, const Colour& colour) {
  implementation_->polygon(corners);
  implementation_->stroke(width, colour);
}

void Canvas::image(const Raster& raster, Vec2 upper_left, double width, double height) {
  cairo_t* context = implementation_->context;
  cairo_surface_t* pixels = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, raster.width, raster.height);
  cairo_surface_flush(pixels);
  unsigned char* rows = cairo_image_surface_get_data(pixels);
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(pixels));
  const std::size_t row_bytes = 4 * static_cast<std::size_t>(raster.width);
  for (std::size_t row = 0; rows != nullptr && row < static_cast<std::size_t>(raster.height); ++row) {
    std::memcpy(rows + row * stride, raster.bytes.data() + row * row_bytes, row_bytes);
  }
  cairo_surface_mark_dirty(pixels);
  cairo_save(context);
  cairo_translate(context, upper_left.x, upper_left.y);
  cairo_scale(context, width / raster.width, height / raster.height);
  cairo_set_source_surface(context, pixels, 0, 0);
  cairo_paint(context);
  cairo_restore(context);
  cairo_surface_destroy(pixels);
}

void Canvas::text(const std::string& text, Vec2 at, double size, TextAnchor anchor, const Colour& colour, bool bold) {
  cairo_t* context = implementation_->context;
  cairo_select_font_face(context, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, size);
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.c_str(), &extents);
  const double share = anchor == TextAnchor::left ? 0 : anchor == TextAnchor::centre ? 0.5 : 1;
  implementation_->source(colour);
  cairo_move_to(context, at.x - share * extents.x_advance, at.y);
  cairo_show_text(context, text.c_str());
  cairo_new_path(context);
}

std::string Canvas::finish() {
  Implementation& page = *implementation_;
  cairo_status_t status = cairo_status(page.context);
  if (status == CAIRO_STATUS_SUCCESS && page.format == PageFormat::png) {
    status = cairo_surface_write_to_png_stream(page.surface, append_bytes, &page.bytes);
  }
  cairo_surface_finish(page.surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(page.surface);
  if (status != CAIRO_STATUS_SUCCESS) {
    computation_failed("the picture could not be drawn", cairo_status_to_string(status),
                       "Ask for a smaller picture, or for fewer discs in it");
  }
  return page.format == PageFormat::svg ? number_anew(page.bytes) : std::move(page.bytes);
}

/// "12.3 kN/m".
std::string with_unit(double value, const std::string& unit) {
  const UnitPrefix prefix = unit_prefix(std::abs(value));
  return fmt::format("{:.3g} {}{}", value * prefix.factor, prefix.prefix, unit);
}

void Bounds::include(Vec2 centre, double radius) {
  low = {std::min(low.x, centre.x - radius), std::min(low.y, centre.y - radius)};
  high = {std::max(high.x, centre.x + radius), std::max(high.y, centre.y + radius)};
}

PageFrame lay_out_page(const Bounds& bounds, bool titled, double right, double shortest) {
  constexpr double bottom = 92, title_room = 66, no_title_room = 26;  // units
  constexpr double tallest = 1.4;                                     // drawing area, in its own widths
  PageFrame frame;
  frame.corner = bounds.low;
  frame.extent = bounds.high - bounds.low;
  const double room = page_width - page_margin - right, top = titled ? title_room : no_title_room;
  frame.scale = std::min(room / frame.extent.x, tallest * room / frame.extent.y);
  const Vec2 size = frame.scale * frame.extent;
  frame.room = {room, std::max(size.y, shortest)};
  frame.origin = {page_margin + 0.5 * (room - size.x), top + 0.5 * (frame.room.y - size.y)};
  frame.height = top + frame.room.y + bottom;
  return frame;
}

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
    const std::string number = fmt::format("{:.6g}", std::abs(tick) < 1e-12 ? 0.0 : tick);
    canvas.text(number.front() == '-' ? "−" + number.substr(1) : number, {right + 9, y + 0.36 * small_text}, small_text,
                TextAnchor::left, ink);
  }
}

void draw_texts(Canvas& canvas, const PageFrame& frame, const std::string& title, const std::string& caption) {
  constexpr double left = page_margin, title_size = 18;
  if (!title.empty()) canvas.text(title, {left, 38}, title_size, TextAnchor::left, ink, true);
  const double length = scale_bar_length(0.2 * frame.room.x / frame.scale);  // m
  const double right = left + length * frame.scale, y = frame.height - 50;
  canvas.line({left, y}, {right, y}, 1.4, ink);
  for (const double x : {left, right}) canvas.line({x, y - 5}, {x, y + 5}, 1.4, ink);
  canvas.text(with_unit(length, "m"), {0.5 * (left + right), y - 9}, small_text, TextAnchor::centre, ink);
  canvas.text(caption, {left, frame.height - 18}, small_text, TextAnchor::left, grey);
}

}  // namespace equidem
