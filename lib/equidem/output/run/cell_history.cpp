// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/run/cell_history.hpp"

#include <string>
#include <utility>
#include <vector>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

struct CellColumn {
  const char* name;
  double (*value)(const CellState&);
};

constexpr CellColumn cell_quantities[] = {
    {"cell_width_m", [](const CellState& c) { return c.width; }},
    {"cell_height_m", [](const CellState& c) { return c.height; }},
    {"cell_shift_m", [](const CellState& c) { return c.shift; }},
    {"cell_area_m2", [](const CellState& c) { return c.area(); }},
    {"cell_strain_xx", [](const CellState& c) { return c.strain.xx; }},
    {"cell_strain_yy", [](const CellState& c) { return c.strain.yy; }},
    {"cell_strain_xy", [](const CellState& c) { return c.strain.xy; }},
    {"cell_stress_xx_Pa", [](const CellState& c) { return c.stress.xx; }},
    {"cell_stress_xy_Pa", [](const CellState& c) { return c.stress.xy; }},
    {"cell_stress_yx_Pa", [](const CellState& c) { return c.stress.yx; }},
    {"cell_stress_yy_Pa", [](const CellState& c) { return c.stress.yy; }},
    {"cell_void_ratio", [](const CellState& c) { return c.void_ratio; }},
    {"cell_coordination_number", [](const CellState& c) { return c.coordination_number; }},
};

}  // namespace

std::vector<std::string> cell_columns() {
  std::vector<std::string> columns;
  for (const CellColumn& column : cell_quantities) columns.emplace_back(column.name);
  return columns;
}

std::vector<double> cell_cells(const CellState& cell) {
  std::vector<double> cells;
  for (const CellColumn& column : cell_quantities) cells.push_back(column.value(cell));
  return cells;
}

Results cell_results(const CellState& cell) {
  Results out;
  out.line("cell")
      .add("width", "", cell.width, "m")
      .note(" by ")
      .add("height", "", cell.height, "m")
      .add("shift", "images above shifted by", cell.shift, "m")
      .set("area", cell.area(), "m²");
  out.line("")
      .add("strain_xx", "strain xx", cell.strain.xx, "", {.digits = 4})
      .add("strain_yy", "yy", cell.strain.yy, "", {.digits = 4})
      .add("strain_xy", "xy", cell.strain.xy, "", {.digits = 4});
  out.line("")
      .add("stress_xx", "stress xx", cell.stress.xx, "Pa", {.digits = 4})
      .add("stress_xy", "xy", cell.stress.xy, "Pa", {.digits = 4})
      .add("stress_yx", "yx", cell.stress.yx, "Pa", {.digits = 4})
      .add("stress_yy", "yy", cell.stress.yy, "Pa", {.digits = 4});
  out.line("")
      .add("void_ratio", "void ratio", cell.void_ratio, "", {.digits = 4})
      .add("coordination_number", "coordination number", cell.coordination_number, "", {.digits = 4});
  return out.under("cell");
}

}  // namespace equidem
