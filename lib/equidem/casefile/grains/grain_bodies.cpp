// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;
using casefile::fail_at;
using casefile::GrainTable;

/// The bodies of a case as they are read.
struct GrainBodies {
  std::vector<Grain> grains;        ///< those of the file, then those of the case
  std::vector<double> densities;    ///< kg/m³
  std::vector<std::string> groups;  ///< of each grain
  std::vector<int> lines;           ///< of the grains of the file
};

/// Columns of a file of grains. The last two are text.
enum Column { x, y, radius, short_half_axis, vx, vy, spin, angle, density, discs, group, columns };
constexpr std::array<const char*, columns> names = {"x",    "y",     "radius",  "short_half_axis", "vx",   "vy",
                                                    "spin", "angle", "density", "discs",           "group"};
/// Columns that a run also writes, ignored by this reader.
constexpr std::array ignored = {"grain", "mass_kg", "mass_kg_per_m"};

/// Columns as written by a run.
constexpr std::array<const char*, columns> with_units = {"x_m",
                                                         "y_m",
                                                         "radius_m",
                                                         "short_half_axis_m",
                                                         "vx_m_per_s",
                                                         "vy_m_per_s",
                                                         "spin_rad_per_s",
                                                         "angle_rad",
                                                         "density_kg_per_m3",
                                                         "discs_m",
                                                         "group"};

/// The column of a name with or without its unit; `columns` where there is none.
std::size_t column_of(std::string_view name) {
  std::size_t c = 0;
  while (c < columns && name != names[c] && name != with_units[c]) ++c;
  return c;
}

/// "x y r; x y r": the discs of a clump in one cell of a table, m.
/// \throws Error (bad_input) where the text is something else
std::vector<Clump::Disc> clump_from(std::string_view text) {
  const auto fail = [&] {
    bad_input(fmt::format("'{}' are no discs of a clump", text),
              "three numbers for each, x y r in m, and ; between them", "Write it like 0 0 0.01; 0.015 0 0.01");
  };
  std::vector<Clump::Disc> discs;
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto finish = [&] {
    if (numbers.size() != 3) fail();
    discs.push_back({{numbers[0], numbers[1]}, numbers[2]});
    numbers.clear();
  };
  while (at != end) {
    if (*at == ' ') {
      ++at;
    } else if (*at == ';') {
      finish();
      ++at;
    } else {
      const auto [rest, problem] = std::from_chars(at, end, numbers.emplace_back());
      const bool ends = rest == end || *rest == ' ' || *rest == ';';
      if (problem != std::errc() || !ends || !std::isfinite(numbers.back())) fail();
      at = rest;
    }
  }
  finish();
  return discs;
}

/// Reads a file of grains row by row.
class GrainFile {
 public:
  explicit GrainFile(const fs::path& path) : file_(path) {}

  void read(std::optional<double> common_density, GrainShapes& shapes, GrainBodies& bodies) {
    if (!file_.next())
      file_.fail("the file has no row of names", "x, y and radius are needed", "Begin it with x,y,radius");
    read_heading();
    while (file_.next()) read_grain(common_density, shapes, bodies);
  }

 private:
  void read_heading() {
    const auto& cells = file_.cells();
    width_ = cells.size();
    at_.fill(width_);
    for (std::size_t c = 0; c < width_; ++c) {
      if (std::find(ignored.begin(), ignored.end(), cells[c]) != ignored.end()) continue;
      const std::size_t column = column_of(cells[c]);
      if (column == columns) {
        const std::size_t bare = column_of(cells[c].substr(0, cells[c].find('_')));
        if (bare != columns)
          file_.fail(fmt::format("the column '{}' is in a unit of its own", cells[c]),
                     "lengths are in m, times in s, angles in rad",
                     fmt::format("Convert it, and name it '{}'", names[bare]));
        const auto meant = nearest(cells[c], std::vector<std::string>(names.begin(), names.end()));
        file_.fail(fmt::format("'{}' is no column of grains", cells[c]),
                   "they are x, y, radius, short_half_axis, vx, vy, spin, angle, density, discs, group",
                   meant ? fmt::format("Did you mean '{}'?", *meant) : "Name the columns in the first row");
      }
      std::size_t& at = at_[column];
      if (at != width_) file_.fail(fmt::format("the column '{}' is there twice", names[column]), "", "Keep one");
      at = c;
    }
    for (const Column needed : {x, y, radius}) {
      if (at_[needed] != width_ || (needed == radius && at_[discs] != width_)) continue;
      file_.fail(fmt::format("the column '{}' is missing", names[needed]), "every grain has a place and a size",
                 "Add it");
    }
  }

  [[nodiscard]] double number(Column column, double otherwise) const {
    if (at_[column] == width_) return otherwise;
    std::string_view text = cell(column);
    if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
    const auto value = number_from<double>(text);
    if (!value || !std::isfinite(*value))
      file_.fail(fmt::format("'{}' is no {}", text, names[column]), "a finite number is needed", "Correct it");
    return *value;
  }

  /// The text of a cell; empty where the column is not there.
  [[nodiscard]] std::string_view cell(Column column) const {
    return at_[column] == width_ ? std::string_view() : file_.cells()[at_[column]];
  }

  void read_grain(std::optional<double> common_density, GrainShapes& shapes, GrainBodies& bodies) const {
    if (const auto count = std::ssize(file_.cells()); static_cast<std::size_t>(count) != width_)
      file_.fail(fmt::format("the row has {}", counted(count, "cell")),
                 fmt::format("the first row names {}", counted(static_cast<long long>(width_), "column")),
                 "Correct it");
    Grain grain;
    grain.position = {number(x, 0), number(y, 0)};
    grain.velocity = {number(vx, 0), number(vy, 0)};
    grain.spin = number(spin, 0);
    grain.angle = number(angle, 0);
    const double own = number(density, common_density.value_or(0));
    if (!(own > 0)) {
      if (at_[density] != width_) file_.fail(fmt::format("the density {} is not positive", own), "", "Correct it");
      file_.fail("the density of the grains is missing", "motion needs their mass",
                 "Add density = ... in kg/m³ to [grains], or a column of that name");
    }
    try {
      read_shape(own, shapes, grain);
    } catch (const Error& error) {
      throw error.at(file_.where());
    }
    bodies.grains.push_back(grain);
    bodies.densities.push_back(own);
    bodies.groups.push_back(read_group());
    bodies.lines.push_back(file_.line());
  }

  void read_shape(double own_density, GrainShapes& shapes, Grain& grain) const {
    const bool is_clump = !cell(discs).empty();
    const double half_axis = cell(short_half_axis).empty() ? 0 : number(short_half_axis, 0);
    if (is_clump && half_axis != 0)
      file_.fail("the grain has discs and a short half-axis", "it is a clump or an ellipse",
                 "Leave one of the cells empty");
    if (!is_clump) {
      const double size = number(radius, 0);
      if (half_axis == 0) return shapes.make_disc(grain, size, own_density);
      return shapes.make_ellipse(grain, size, half_axis, own_density);
    }
    shapes.make_clump(grain, clump_from(cell(discs)), own_density);
    if (cell(radius).empty()) return;
    constexpr double tolerance = 1e-9;
    const double size = number(radius, 0);
    if (std::abs(size - grain.radius) > tolerance * grain.radius) {
      file_.fail(fmt::format("the radius is {} m, and the discs reach {} m from their mass centre", size, grain.radius),
                 "that is the radius of a clump", "Correct one of them, or leave the radius empty");
    }
  }

  [[nodiscard]] std::string read_group() const {
    const std::string_view name = cell(group);
    if (name.empty()) return "grains";
    if (!casefile::is_plain_name(name))
      file_.fail(fmt::format("'{}' cannot name a group", name), "it stands in tables",
                 "Use letters, digits, '_' and '-' only");
    if (name == "walls")
      file_.fail("a group of grains is called 'walls'", "the name stands for all walls", "Name it otherwise");
    return std::string(name);
  }

  TableFile file_;
  std::size_t width_ = 0;
  std::array<std::size_t, columns> at_{};
};

/// Disc, ellipse or clump.
void read_shape(const TomlValue& table, const GrainTable& read, double density, GrainShapes& shapes, Grain& grain) {
  const TomlValue* given = nullptr;
  std::string key;
  for (const char* name : {"radius", "half_axes", "discs"}) {
    const TomlValue* value = table.find(name);
    if (value == nullptr) continue;
    if (given != nullptr)
      fail_at(*value, fmt::format("grain.{}", name), fmt::format("{} and {} are both given", key, name),
              "a body has one shape: radius is for a disc, half_axes for an ellipse, discs for a clump",
              "Remove one of them");
    given = value;
    key = name;
  }
  if (given == nullptr)
    fail_at(table, "grain", "it is not said what shape the grain has",
            "radius is for a disc, half_axes for an ellipse, discs for a clump",
            "Add one of them, such as radius = 0.01");
  try {
    if (read.radius) return shapes.make_disc(grain, *read.radius, density);
    if (read.half_axes) return shapes.make_ellipse(grain, read.half_axes->x, read.half_axes->y, density);
    shapes.make_clump(grain, read.discs, density);
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: grain.{}", given->where(), key));
  }
}

void add_grain(const TomlValue& table, const GrainTable& read, std::optional<double> common_density,
               GrainShapes& shapes, GrainBodies& bodies) {
  if (!read.density && !common_density) {
    fail_at(table, "grain.density", "the density is missing", "motion needs the mass of the grains",
            "Add density = ... in kg/m³ to [grains], or to each [[grain]]");
  }
  const TomlValue& group = *table.find("group");
  if (read.group.empty()) fail_at(group, "grain.group", "the name is empty", "a group is known by its name", "Name it");
  casefile::check_plain_name(group, "grain.group", "a group", "it stands in tables");
  Grain grain = read.grain;
  bodies.densities.push_back(read.density ? *read.density : *common_density);
  read_shape(table, read, bodies.densities.back(), shapes, grain);
  bodies.grains.push_back(grain);
  bodies.groups.push_back(read.group);
}

}  // namespace

std::vector<std::string> casefile::read_bodies(const TomlValue& root, GrainTables& tables) {
  GrainBodies bodies;
  const CommonBodyTable& common = tables.common;
  tables.body = common.body;
  GrainShapes shapes(common.body);
  if (common.path) {
    try {
      GrainFile(*common.path).read(common.density, shapes, bodies);
    } catch (const Error& error) {
      throw error.at(fmt::format("{}: grains.path", root.find("grains")->find("path")->where()));
    }
    tables.grain_file = common.path->string();
  }
  for (std::size_t k = 0; k < tables.grain_tables.size(); ++k)
    add_grain(repeated(root, "grain")[k], tables.grain_tables[k], common.density, shapes, bodies);
  if (bodies.grains.empty()) {
    fail_at(root, "grain", "there are no grains", "something has to move",
            "Add [[grain]] with position and radius, or [grains] with path");
  }
  tables.scene.grains = std::move(bodies.grains);
  tables.scene.clumps = shapes.clumps();
  tables.densities = std::move(bodies.densities);
  tables.grain_lines = std::move(bodies.lines);
  return std::move(bodies.groups);
}

}  // namespace equidem
