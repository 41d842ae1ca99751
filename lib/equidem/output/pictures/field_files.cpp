// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/field_files.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/pictures/canvas.hpp"

namespace equidem {
namespace {

using Values = std::vector<double>;

template <typename Value>
Values values_of(const CoarseFields& fields, const Value& value) {
  Values values;
  for (std::size_t k = 0; k < fields.grid.size(); ++k) values.push_back(value(k));
  return values;
}

Values pressure_of(const CoarseFields& fields) {
  return values_of(fields, [&](std::size_t k) { return -0.5 * (fields.stress[k].xx + fields.stress[k].yy); });
}

/// The fields by their names, each with a value for each cell.
std::vector<std::pair<const char*, Values>> fields_of(const CoarseFields& f) {
  return {{"stress_xx_Pa", values_of(f, [&](std::size_t k) { return f.stress[k].xx; })},
          {"stress_yy_Pa", values_of(f, [&](std::size_t k) { return f.stress[k].yy; })},
          {"stress_xy_Pa", values_of(f, [&](std::size_t k) { return f.stress[k].xy; })},
          {"stress_yx_Pa", values_of(f, [&](std::size_t k) { return f.stress[k].yx; })},
          {"pressure_Pa", pressure_of(f)},
          {"solid_fraction", f.solid_fraction},
          {"coordination", f.coordination},
          {"vx_m_per_s", values_of(f, [&](std::size_t k) { return f.velocity[k].x; })},
          {"vy_m_per_s", values_of(f, [&](std::size_t k) { return f.velocity[k].y; })}};
}

Table table_of(const CoarseFields& fields) {
  const auto middle = [&](std::size_t k) {
    const Rectangle cell = fields.grid.cell(k);
    return 0.5 * (cell.low + cell.high);
  };
  Table table;
  table.add("x_m", values_of(fields, [&](std::size_t k) { return middle(k).x; }))
      .add("y_m", values_of(fields, [&](std::size_t k) { return middle(k).y; }));
  for (auto& [name, values] : fields_of(fields)) table.add(name, std::move(values));
  return table;
}

/// One image, cells in rows from below; raw numbers behind the declarations.
std::string image_text(const CoarseFields& fields) {
  const CoarseGrid& grid = fields.grid;
  const Vec2 size = grid.cell_size();
  const std::string extent = fmt::format("0 {} 0 {} 0 0", grid.columns, grid.rows);
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"{}\" header_type=\"UInt64\">\n"
      "  <ImageData WholeExtent=\"{}\" Origin=\"{} {} 0\" Spacing=\"{} {} 1\">\n    <Piece Extent=\"{}\">\n      "
      "<CellData>\n",
      vtk_byte_order(), extent, grid.region.low.x, grid.region.low.y, size.x, size.y, extent);
  std::string numbers;
  const auto append = [&](auto number) {
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    numbers.append(bytes, sizeof number);
  };
  for (const auto& [name, values] : fields_of(fields)) {
    text += fmt::format("        <DataArray type=\"Float64\" Name=\"{}\" format=\"appended\" offset=\"{}\"/>\n", name,
                        numbers.size());
    append(std::uint64_t{8 * values.size()});
    for (const double value : values) append(value);
  }
  return text + "      </CellData>\n    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n_" + numbers +
         "\n  </AppendedData>\n</VTKFile>\n";
}

constexpr double map_gap = 50, map_bar = 14, map_bar_room = 78, map_title_room = 34;  // units

/// A map in the width given, its colour bar to the right. \param unit of the values, or nothing
void draw_map(Canvas& canvas, const CoarseGrid& grid, Values values, const std::string& title, const std::string& unit,
              Vec2 corner, double width, double height) {
  const ColourScale pure = colour_scale(values);
  const UnitPrefix prefix =
      unit.empty() ? UnitPrefix{} : unit_prefix(std::max(std::abs(pure.low), std::abs(pure.high)));
  for (double& value : values) value *= prefix.factor;
  const ColourScale scale = colour_scale(values);
  const Vec2 size = grid.region.high - grid.region.low;
  const double shown = std::min(width / size.x, height / size.y);
  const double w = shown * size.x, h = shown * size.y;
  Raster raster(static_cast<int>(grid.columns), static_cast<int>(grid.rows));
  for (std::size_t k = 0; k < grid.size(); ++k)
    raster.set(static_cast<int>(k % grid.columns), static_cast<int>(grid.rows - 1 - k / grid.columns),
               scale.colour_of(values[k]));
  canvas.text(unit.empty() ? title : fmt::format("{}, {}{}", title, prefix.prefix, unit), {corner.x, corner.y - 12}, 14,
              TextAnchor::left, ink, true);
  // Few cells are drawn as polygons: viewers smooth an image, which blurs its cells.
  const double cw = w / static_cast<double>(grid.columns), ch = h / static_cast<double>(grid.rows);
  if (grid.size() > 20'000) {
    canvas.image(raster, corner, w, h);
  } else {
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const double x = corner.x + cw * static_cast<double>(k % grid.columns);
      const double y = corner.y + h - ch * static_cast<double>(k / grid.columns + 1);
      canvas.fill_polygon({{x, y}, {x + cw + 0.3, y}, {x + cw + 0.3, y + ch + 0.3}, {x, y + ch + 0.3}},
                          scale.colour_of(values[k]));
    }
  }
  canvas.stroke_polygon({corner, {corner.x + w, corner.y}, {corner.x + w, corner.y + h}, {corner.x, corner.y + h}}, 0.8,
                        ink);
  draw_colour_bar(canvas, scale, {corner.x + w + 12, corner.y}, map_bar, h);
}

std::string draw(const CoarseFields& fields) {
  const Values speed = values_of(fields, [&](std::size_t k) { return norm(fields.velocity[k]); });
  struct Map {
    const char *title, *unit;
    Values values;
  };
  const Map maps[] = {{"pressure", "Pa", pressure_of(fields)},
                      {"solid fraction", "", fields.solid_fraction},
                      {"coordination", "", fields.coordination},
                      {"speed", "m/s", speed}};
  const Vec2 size = fields.grid.region.high - fields.grid.region.low;
  const double width = 0.5 * (page_width - 2 * page_margin - map_gap) - map_bar_room;
  const double height = std::clamp(width * size.y / size.x, 60.0, 1.5 * width);
  const double pitch = height + map_title_room + 26;
  Canvas canvas(PageFormat::png, 2 * pitch + 16);
  for (std::size_t k = 0; k < 4; ++k)
    draw_map(canvas, fields.grid, maps[k].values, maps[k].title, maps[k].unit,
             {page_margin + static_cast<double>(k % 2) * (width + map_bar_room + map_gap),
              map_title_room + static_cast<double>(k / 2) * pitch},
             width, height);
  return canvas.finish();
}

}  // namespace

std::vector<std::filesystem::path> write_fields(const std::filesystem::path& folder, const std::string& name,
                                                const CoarseFields& fields, bool overwrite) {
  const std::vector<std::filesystem::path> paths{folder / (name + ".csv"), folder / (name + ".vti"),
                                                 folder / (name + ".png")};
  for (const auto& path : paths) check_writable(path, overwrite);
  write_csv(paths[0], table_of(fields), overwrite);
  if (fields.grid.size() == 0) {
    for (const auto& path : {paths[1], paths[2]}) std::filesystem::remove(path);  // of an earlier run
    return {paths[0]};
  }
  write_file(paths[1], image_text(fields), overwrite);
  write_file(paths[2], draw(fields), overwrite);
  return paths;
}

}  // namespace equidem
