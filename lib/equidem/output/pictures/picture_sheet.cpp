// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/picture_sheet.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/output/pictures/canvas.hpp"

namespace equidem {

void write_picture_sheet(const std::filesystem::path& file, const std::string& title,
                         const std::vector<SheetPicture>& pictures, std::size_t columns, bool overwrite) {
  constexpr double cell = 450, gap = 16, head = 48;  // pixels
  constexpr Colour black{0, 0, 0};
  if (pictures.empty()) bad_input_at(file.string(), "the sheet would be empty", "there are no pictures", "Give some");
  columns = std::min(columns, pictures.size());
  std::vector<Raster> rasters;
  std::vector<double> heights;  // of the highest picture of each row
  const auto height_of = [](const Raster& raster) { return cell * raster.height / raster.width; };
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    rasters.push_back(read_png(pictures[k].file));
    if (k % columns == 0) heights.push_back(0);
    heights.back() = std::max(heights.back(), height_of(rasters.back()));
  }
  const bool labelled = std::ranges::any_of(pictures, [](const SheetPicture& one) { return !one.label.empty(); });
  const double label = labelled ? 28 : 0;
  double bottom = head;
  for (const double height : heights) bottom += label + height + gap;
  const double width = static_cast<double>(columns) * (cell + gap) + gap;
  Canvas canvas(PageFormat::png, static_cast<int>(width), static_cast<int>(std::ceil(bottom)), 1);
  canvas.text(title, {0.5 * width, 34}, 24, TextAnchor::centre, black, true);
  double top = head;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const std::size_t row = k / columns, column = k % columns;
    if (column == 0 && row > 0) top += label + heights[row - 1] + gap;
    const double left = gap + static_cast<double>(column) * (cell + gap), drawn = height_of(rasters[k]);
    canvas.text(pictures[k].label, {left + 0.5 * cell, top + 20}, 18, TextAnchor::centre, black);
    canvas.image(rasters[k], {left, top + label + heights[row] - drawn}, cell, drawn);
  }
  write_file(file, canvas.finish(), overwrite);
}

}  // namespace equidem
