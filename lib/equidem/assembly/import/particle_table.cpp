// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "equidem/assembly/import/length_unit.hpp"
#include "equidem/assembly/import/number_table.hpp"
#include "equidem/assembly/import/particle_rows.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

const std::vector<std::string> id_names = {"id", "grain", "disc", "particle"}, x_names = {"x"}, y_names = {"y"},
                               z_names = {"z"}, radius_names = {"radius", "r", "rad"},
                               diameter_names = {"diameter", "d"};

using ColumnPlace = std::optional<std::size_t>;

struct ParticleColumns {
  std::size_t x = 0, y = 1, size = 2;
  ColumnPlace z = {}, id = {}, period_x = {}, period_y = {};
  bool is_diameter = false;
};

ParticleColumns particle_columns(const NumberTable& table) {
  ParticleColumns c;
  if (table.names().empty()) {
    if (table.width() != 3 && table.width() != 4)
      bad_input_at(fmt::format("line {}", table.line()),
                   fmt::format("the table has {} columns without names", table.width()),
                   "without names three are x y r, and four x y z r", "Name them in a first line: x y radius");
    if (table.width() == 4) c = {.size = 3, .z = 2};
    return c;
  }
  const std::string why = "every disc has a place and a size";
  c.x = table.need(x_names, why);
  c.y = table.need(y_names, why);
  c.z = table.find(z_names);
  c.id = table.find(id_names);
  c.is_diameter = !table.find(radius_names) && table.find(diameter_names);
  c.size = table.need(c.is_diameter ? diameter_names : radius_names, why);
  c.period_x = table.find({"period_x"});
  c.period_y = table.find({"period_y"});
  return c;
}

/// The unit that the names of all lengths carry; none where none does.
std::optional<double> unit_of_columns(const NumberTable& table, const ParticleColumns& columns) {
  if (table.names().empty()) return {};
  std::string unit = table.names()[columns.x].unit;
  for (const ColumnPlace place :
       {ColumnPlace(columns.y), ColumnPlace(columns.size), columns.z, columns.period_x, columns.period_y}) {
    if (!place || table.names()[*place].unit == unit) continue;
    bad_input_at(fmt::format("line {}", table.line_of_names()),
                 fmt::format("the columns '{}' and '{}' are in different units", table.names()[columns.x].name,
                             table.names()[*place].name),
                 "places, sizes and periods have one unit", "Convert one of them");
  }
  return unit.empty() ? std::nullopt : length_unit(unit);
}

/// Ellipses and clumps of files of grains.
void refuse_other_shapes(const NumberTable& table) {
  for (const char* name : {"short_half_axis", "discs"}) {
    const auto place = table.find({name});
    if (!place || table.cells()[*place].empty()) continue;
    bad_input_at(fmt::format("line {}", table.line()), fmt::format("the body has the column '{}'", name),
                 "it is no disc, and its contacts do not follow from a radius",
                 "Name the assembly.json that 'equidem pack' writes beside grains.csv");
  }
}

}  // namespace

ParticleRows read_particle_table(std::string_view text) {
  NumberTable table(text);
  const ParticleColumns columns = particle_columns(table);
  ParticleRows result{.format = table.by_yade() ? "a text export of YADE" : "a table of particles"};
  result.unit = unit_of_columns(table, columns);
  const auto number = [&](std::size_t column, std::string_view name) {
    return finite_number(table.cells()[column], name, table.line());
  };
  if (columns.period_x.has_value() != columns.period_y.has_value())
    bad_input_at(fmt::format("line {}", table.line_of_names()), "only one of period_x and period_y is there",
                 "a cell is periodic along both", "Give both, or none");
  if (columns.period_x) {
    const Vec2 size{number(*columns.period_x, "period_x"), number(*columns.period_y, "period_y")};
    result.box = ParticleRows::Box{.low = {}, .high = size, .periodic_x = true, .periodic_y = true};
  }
  do {
    refuse_other_shapes(table);
    const double size = number(columns.size, columns.is_diameter ? "diameter" : "radius");
    result.particles.push_back(
        {.id = columns.id ? whole_number(table.cells()[*columns.id], "id", table.line()) : std::ssize(result.particles),
         .x = number(columns.x, "x"),
         .y = number(columns.y, "y"),
         .z = columns.z ? number(*columns.z, "z") : 0,
         .radius = columns.is_diameter ? 0.5 * size : size,
         .line = table.line()});
  } while (table.next());
  return result;
}

}  // namespace equidem
