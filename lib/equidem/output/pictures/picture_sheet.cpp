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
  constexpr double cell = 600, gap = 16, head = 48;  // pixels
  constexpr Colour black{0, 0, 0};
  if (pictures.empty()) bad_input_at(file.string(), "the sheet would be empty", "there are no pictures", "Give some");
  const bool labelled = std::ranges::any_of(pictures, [](const SheetPicture& one) { return !one.label.empty(); });
  const double label = labelled ? 28 : 0;  // pixels
  columns = std::min(columns, pictures.size());
  std::vector<Raster> rasters;
  double highest = 0;
  for (const SheetPicture& picture : pictures) {
    rasters.push_back(read_png(picture.file));
    highest = std::max(highest, cell * rasters.back().height / rasters.back().width);
  }
  const std::size_t rows = (pictures.size() + columns - 1) / columns;
  const double width = static_cast<double>(columns) * (cell + gap) + gap;
  const double height = head + static_cast<double>(rows) * (label + highest + gap);
  Canvas canvas(PageFormat::png, static_cast<int>(width), static_cast<int>(std::ceil(height)), 1);
  canvas.text(title, {0.5 * width, 34}, 24, TextAnchor::centre, black, true);
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const double left = gap + static_cast<double>(k % columns) * (cell + gap);
    const double top = head + static_cast<double>(k / columns) * (label + highest + gap);
    const double drawn = cell * rasters[k].height / rasters[k].width;
    canvas.text(pictures[k].label, {left + 0.5 * cell, top + 20}, 20, TextAnchor::centre, black);
    canvas.image(rasters[k], {left, top + label + highest - drawn}, cell, drawn);
  }
  write_file(file, canvas.finish(), overwrite);
}

}  // namespace equidem
