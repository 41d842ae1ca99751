// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/import/particle_table.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

std::string_view without_plus(std::string_view text) {
  return text.size() > 1 && text.front() == '+' && text[1] != '-' ? text.substr(1) : text;
}

}  // namespace

bool TextLines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  line_ = trimmed(rest_.substr(0, end));
  is_whole_ = end < rest_.size();
  rest_.remove_prefix(end);
  rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, rest_.size()));
  ++number_;
  return true;
}

void TextLines::fail(std::string problem, std::string why, std::string remedy) const {
  bad_input_at(fmt::format("line {}", number_), std::move(problem), std::move(why), std::move(remedy));
}

double finite_number(std::string_view text, std::string_view column, int line) {
  const auto value = number_from<double>(without_plus(text));
  if (value && std::isfinite(*value)) return *value;
  bad_input_at(fmt::format("line {}", line), fmt::format("'{}' is no {}", text, column), "a finite number is needed",
               "Correct it");
}

std::int64_t whole_number(std::string_view text, std::string_view column, int line) {
  if (const auto value = number_from<std::int64_t>(without_plus(text))) return *value;
  bad_input_at(fmt::format("line {}", line), fmt::format("'{}' is no {}", text, column), "a whole number is needed",
               "Correct it");
}

namespace {

/// "1000 atoms", a line of the header of a LAMMPS data file.
bool counts_atoms(std::string_view line) {
  const auto words = words_of(line.substr(0, line.find('#')));
  return words.size() == 2 && words[1] == "atoms" && words[0].find_first_not_of("0123456789") == std::string_view::npos;
}

struct LammpsUnits {
  std::string_view name;
  double metres;
};
constexpr LammpsUnits lammps_units[] = {{"si", 1}, {"cgs", 0.01}, {"micro", 1e-6}, {"nano", 1e-9}};

}  // namespace

std::optional<double> lammps_length_unit(std::string_view name) {
  for (const LammpsUnits& units : lammps_units)
    if (units.name == name) return units.metres;
  return {};
}

ParticleFormat particle_format(std::string_view text) {
  constexpr int lines_of_header = 30;
  text = without_byte_order_mark(text);
  TextLines lines(text);
  std::string_view first;
  for (int k = 0; k < lines_of_header && lines.next(); ++k) {
    if (first.empty()) first = lines.line();
    if (first.starts_with("ITEM:")) return ParticleFormat::lammps_dump;
    if (counts_atoms(lines.line())) return ParticleFormat::lammps_data;
  }
  const bool other = first.empty() || first.front() == '{' || first.front() == '[' ||
                     text.substr(0, first.size() + 1).find('\0') != std::string_view::npos;
  return other ? ParticleFormat::none : ParticleFormat::table;
}

namespace {

const std::vector<std::string> id_names = {"id", "grain", "disc", "particle"}, x_names = {"x"}, y_names = {"y"},
                               z_names = {"z"}, radius_names = {"radius", "r", "rad"},
                               diameter_names = {"diameter", "d"};

using ColumnPlace = std::optional<std::size_t>;

struct ParticleColumns {
  std::size_t x = 0, y = 1;
  ColumnPlace z = {}, id = {}, radius = {}, diameter = {}, period_x = {}, period_y = {};

  /// Those that are lengths and there.
  [[nodiscard]] std::vector<std::size_t> lengths() const {
    std::vector<std::size_t> all{x, y};
    for (const ColumnPlace place : {z, radius, diameter, period_x, period_y})
      if (place) all.push_back(*place);
    return all;
  }
};

/// The columns of YADE's export.textExt.
std::optional<std::string> columns_of_yade(const TableFile& table, std::string_view comment) {
  constexpr std::string_view format = "format ";
  if (!comment.starts_with(format)) return {};
  const std::string_view name = trimmed(comment.substr(format.size()));
  if (name == "x_y_z_r" || name == "x_y_z_r_attrs") return "x y z r";
  if (name == "x_y_z_r_matId") return "x y z r matId";
  if (name == "id_x_y_z_r_matId") return "id x y z r matId";
  table.fail(fmt::format("'{}' is no format of places and radii", name),
             "those of export.textExt are x_y_z_r, x_y_z_r_matId, x_y_z_r_attrs and id_x_y_z_r_matId",
             "Export it with one of them");
}

ParticleColumns particle_columns(const TableFile& table) {
  ParticleColumns c;
  if (table.names().empty()) {
    if (table.width() != 3 && table.width() != 4) {
      table.refuse_decimal_commas();
      table.fail(fmt::format("the table has {} columns without names", table.width()),
                 "without names three are x y r, and four x y z r", "Name them in a first line: x y radius");
    }
    c.radius = table.width() - 1;
    if (table.width() == 4) c.z = 2;
    return c;
  }
  const std::string why = "every disc has a place and a size";
  c.x = table.need(x_names, why);
  c.y = table.need(y_names, why);
  c.z = table.find(z_names);
  c.id = table.find(id_names);
  c.diameter = table.find(diameter_names);
  c.radius = c.diameter ? table.find(radius_names) : table.need(radius_names, why);
  c.period_x = table.find({"period_x"});
  c.period_y = table.find({"period_y"});
  if (c.period_x.has_value() != c.period_y.has_value())
    table.fail_at_names("only one of period_x and period_y is there", "a cell is periodic along both",
                        "Give both, or none");
  return c;
}

/// The unit that the names of all lengths carry; none where none does.
std::optional<double> unit_of_columns(const TableFile& table, const ParticleColumns& columns) {
  const std::vector<std::size_t> lengths = columns.lengths();
  const auto unit = table.factor(columns.x, Dimension::length);
  for (const std::size_t column : lengths) {
    if (table.factor(column, Dimension::length) != unit)
      table.fail_at_names(fmt::format("the columns '{}' and '{}' are in different units", table.names()[columns.x].text,
                                      table.names()[column].text),
                          "places, sizes and periods have one unit", "Convert one of them");
  }
  return unit;
}

/// The radius, in the unit of the file. Where the diameter is there, too, both agree.
double radius_of_row(const TableFile& table, const ParticleColumns& columns) {
  constexpr double rounding = 1e-5;  // of numbers with six digits
  const double radius = columns.radius ? table.number(*columns.radius, "radius") : 0;
  if (!columns.diameter) return radius;
  const double half = 0.5 * table.number(*columns.diameter, "diameter");
  if (columns.radius && std::abs(half - radius) > rounding * std::abs(radius))
    table.fail(fmt::format("the radius is {} and the diameter {}", radius, 2 * half), "one is not half of the other",
               "Take one of the columns out");
  return columns.radius ? radius : half;
}

/// Ellipses and clumps of files of grains.
void refuse_other_shapes(const TableFile& table, std::span<const std::size_t> columns) {
  for (const std::size_t column : columns) {
    if (table.cells()[column].empty()) continue;
    table.fail(fmt::format("the body has the column '{}'", table.names()[column].name),
               "it is no disc, and its contacts do not follow from a radius",
               "Name the assembly.json that 'equidem pack' writes beside grains.csv");
  }
}

}  // namespace

ParticleRows read_particle_table(std::string_view text) {
  TableFile table(text, {}, {x_names, y_names}, columns_of_yade);
  if (!table.next()) bad_input("the table has no rows", "every row is a particle", "Write it again");
  const ParticleColumns columns = particle_columns(table);
  ParticleRows result{.format = table.names_by_format() ? "a text export of YADE" : "a table of particles"};
  result.unit = unit_of_columns(table, columns);
  std::vector<std::size_t> other_shapes;
  for (const char* name : {"short_half_axis", "discs"})
    if (const auto place = table.find({name})) other_shapes.push_back(*place);
  if (columns.period_x) {
    const Vec2 size{table.number(*columns.period_x, "period_x"), table.number(*columns.period_y, "period_y")};
    result.box = ParticleRows::Box{.low = {}, .high = size, .periodic_x = true, .periodic_y = true};
  }
  do {
    refuse_other_shapes(table, other_shapes);
    result.particles.push_back({.id = columns.id ? table.whole(*columns.id, "id") : std::ssize(result.particles),
                                .x = table.number(columns.x, "x"),
                                .y = table.number(columns.y, "y"),
                                .z = columns.z ? table.number(*columns.z, "z") : 0,
                                .radius = radius_of_row(table, columns),
                                .line = table.line()});
  } while (table.next());
  return result;
}

}  // namespace equidem
