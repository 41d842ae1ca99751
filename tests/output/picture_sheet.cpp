// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/picture_sheet.hpp"

#include <cstring>
#include <string>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/output/pictures/canvas.hpp"

#include "output/states.hpp"
#include "support/catch.hpp"

using namespace equidem;

namespace {

/// A PNG of one colour.
void write_plain(const std::filesystem::path& file, int width, int height, const Colour& colour) {
  Canvas canvas(PageFormat::png, width, height, 1);
  const double w = width, h = height;
  canvas.fill_polygon({{0, 0}, {w, 0}, {w, h}, {0, h}}, colour);
  write_file(file, canvas.finish(), false);
}

std::uint32_t pixel(const Raster& raster, int x, int y) {
  std::uint32_t argb = 0;
  std::memcpy(&argb, &raster.bytes[4 * static_cast<std::size_t>(y * raster.width + x)], sizeof argb);
  return argb;
}

}  // namespace

TEST_CASE("a_sheet_shows_its_pictures_in_rows_with_one_width") {
  const TemporaryFolder folder;
  const auto red = folder.path() / "red.png", blue = folder.path() / "blue.png", sheet = folder.path() / "sheet.png";
  write_plain(red, 300, 200, {1, 0, 0});
  write_plain(blue, 900, 300, {0, 0, 1});
  write_picture_sheet(sheet, "two colours", {{red, "red"}, {blue, "blue"}, {blue, "blue again"}}, 2, false);
  const Raster drawn = read_png(sheet);
  REQUIRE(drawn.width == 2 * 466 + 16);
  // Above each row 28 pixels for the labels; at a width of 450 the red picture is 300 high, the blue one 150.
  REQUIRE(drawn.height == 48 + (28 + 300 + 16) + (28 + 150 + 16));
  CHECK(pixel(drawn, 241, 226) == 0xffff0000U);
  CHECK(pixel(drawn, 707, 301) == 0xff0000ffU);
  CHECK(pixel(drawn, 707, 150) == 0xffffffffU);
  CHECK(pixel(drawn, 241, 495) == 0xff0000ffU);
  CHECK(pixel(drawn, 707, 495) == 0xffffffffU);
}

TEST_CASE("a_sheet_of_nothing_or_of_what_is_no_picture_is_refused") {
  const TemporaryFolder folder;
  const auto text = folder.path() / "text.png", sheet = folder.path() / "sheet.png";
  write_file(text, "no picture", false);
  CHECK_THROWS_AS(write_picture_sheet(sheet, "", {}, 2, false), Error);
  CHECK_THROWS_AS(write_picture_sheet(sheet, "", {{text, ""}}, 2, false), Error);
  CHECK_THROWS_AS(write_picture_sheet(sheet, "", {{folder.path() / "none.png", ""}}, 2, false), Error);
  CHECK(!std::filesystem::exists(sheet));
}
