// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
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

constexpr const char* font = "sans-serif";

cairo_status_t append_bytes(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

/// Bytes that start here and form one UTF-8 character; 0 where they form none. Control characters are none.
std::size_t character_length(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char first = byte(at);
  if (first < 0x80) return first < 0x20 || first == 0x7f ? 0 : 1;
  const std::size_t length = first >= 0xc2 && first < 0xe0   ? 2
                             : first >= 0xe0 && first < 0xf0 ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
  if (length == 0 || at + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(at + k) & 0xc0) != 0x80) return 0;
  }
  const unsigned char second = byte(at + 1);  // no overlong forms, surrogates or code points above U+10FFFF
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f)) return 0;
  if ((first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) return 0;
  return length;
}

/// Text that is not UTF-8 makes cairo reject the whole page.
std::string valid_utf8(const std::string& text) {
  std::string valid;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = character_length(text, at);
    valid += length == 0 ? "?" : text.substr(at, length);
    at += length == 0 ? 1 : length;
  }
  return valid;
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

Raster read_png(const std::filesystem::path& path) {
  cairo_surface_t* file = cairo_image_surface_create_from_png(path.c_str());
  const cairo_status_t status = cairo_surface_status(file);
  if (status != CAIRO_STATUS_SUCCESS) {
    cairo_surface_destroy(file);
    bad_input_at(path.string(), "the picture cannot be read", cairo_status_to_string(status), "Draw it again");
  }
  Raster raster(cairo_image_surface_get_width(file), cairo_image_surface_get_height(file));
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(file));
  const std::size_t row_bytes = 4 * static_cast<std::size_t>(raster.width);
  const bool opaque = cairo_image_surface_get_format(file) == CAIRO_FORMAT_RGB24;
  for (std::size_t row = 0; row < static_cast<std::size_t>(raster.height); ++row)
    std::memcpy(&raster.bytes[row * row_bytes], cairo_image_surface_get_data(file) + row * stride, row_bytes);
  cairo_surface_destroy(file);
  for (std::size_t pixel = 0; opaque && pixel < raster.bytes.size(); pixel += 4) {
    std::uint32_t argb = 0;
    std::memcpy(&argb, &raster.bytes[pixel], sizeof argb);
    argb |= 0xff000000U;  // undefined in RGB24
    std::memcpy(&raster.bytes[pixel], &argb, sizeof argb);
  }
  return raster;
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
  void choose_font(double size, bool bold) const {
    cairo_select_font_face(context, font, CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context, size);
  }
};

Canvas::Canvas(PageFormat format, int width, int height, double unit)
    : implementation_(std::make_unique<Implementation>(Implementation{format, {}})) {
  Implementation& page = *implementation_;
  page.surface = format == PageFormat::png
                     ? cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)
                     : cairo_svg_surface_create_for_stream(append_bytes, &page.bytes, width, height);
  page.context = cairo_create(page.surface);
  if (cairo_status(page.context) != CAIRO_STATUS_SUCCESS) {
    computation_failed(fmt::format("a page of {} x {} pixels could not be made", width, height),
                       cairo_status_to_string(cairo_status(page.context)), "Ask for a smaller picture");
  }
  cairo_set_source_rgb(page.context, 1, 1, 1);
  cairo_paint(page.context);
  cairo_scale(page.context, unit, unit);
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
  const double width = anchor == TextAnchor::left ? 0 : text_width(text, size, bold);
  const double back = anchor == TextAnchor::right ? width : 0.5 * width;
  implementation_->choose_font(size, bold);
  implementation_->source(colour);
  cairo_move_to(implementation_->context, at.x - (anchor == TextAnchor::left ? 0 : back), at.y);
  cairo_show_text(implementation_->context, valid_utf8(text).c_str());
  cairo_new_path(implementation_->context);
}

double Canvas::text_width(const std::string& text, double size, bool bold) {
  implementation_->choose_font(size, bold);
  cairo_text_extents_t extents;
  cairo_text_extents(implementation_->context, valid_utf8(text).c_str(), &extents);
  return extents.x_advance;
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

}  // namespace equidem
