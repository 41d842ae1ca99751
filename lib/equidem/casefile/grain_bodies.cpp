// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grain_bodies.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "equidem/casefile/read_value.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/nearest.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;

std::string_view trimmed(std::string_view text) {
  constexpr const char* space = " \t\r";
  text.remove_prefix(std::min(text.find_first_not_of(space), text.size()));
  return text.substr(0, text.find_last_not_of(space) + 1);
}

std::vector<std::string_view> cells_of(std::string_view row) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = row.find(',');
    cells.push_back(trimmed(row.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    row.remove_prefix(comma + 1);
  }
}

/// Columns of a file of grains. The last one is text.
enum Column { x, y, radius, vx, vy, spin, angle, density, group, columns };
constexpr std::array<const char*, columns> names = {"x",    "y",     "radius",  "vx",   "vy",
                                                    "spin", "angle", "density", "group"};
/// What a run writes beside, and this reader passes over.
constexpr std::array ignored = {"grain", "mass_kg", "mass_kg_per_m"};

/// As a run writes them.
constexpr std::array<const char*, columns> with_units = {
    "x_m", "y_m", "radius_m", "vx_m_per_s", "vy_m_per_s", "spin_rad_per_s", "angle_rad", "density_kg_per_m3", "group"};

/// The column of a name with or without its unit; `columns` where there is none.
std::size_t column_of(std::string_view name) {
  std::size_t c = 0;
  while (c < columns && name != names[c] && name != with_units[c]) ++c;
  return c;
}

/// Reads a file of grains line by line.
class GrainFile {
 public:
  explicit GrainFile(fs::path path) : path_(std::move(path)) {}

  void read(std::optional<double> common_density, GrainBodies& bodies) {
    const std::string content = read_file(path_);
    std::string_view rest = content;
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (rest.starts_with(byte_order_mark)) rest.remove_prefix(byte_order_mark.size());
    for (line_ = 1; !rest.empty(); ++line_) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      const std::string_view row = trimmed(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (row.empty() || row.front() == '#') continue;
      if (width_ == 0) {
        read_heading(row);
      } else {
        read_grain(row, common_density, bodies);
      }
    }
    if (width_ == 0) fail("the file has no row of names", "x, y and radius are needed", "Begin it with x,y,radius");
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& why, const std::string& remedy) const {
    throw Error(ErrorKind::bad_input, problem, why, remedy, format("{}:{}", path_.string(), line_));
  }

  void read_heading(std::string_view row) {
    const auto cells = cells_of(row);
    width_ = cells.size();
    at_.fill(width_);
    for (std::size_t c = 0; c < width_; ++c) {
      if (std::find(ignored.begin(), ignored.end(), cells[c]) != ignored.end()) continue;
      const std::size_t column = column_of(cells[c]);
      if (column == columns) {
        const std::size_t bare = column_of(cells[c].substr(0, cells[c].find('_')));
        if (bare != columns)
          fail(format("the column '{}' is in a unit of its own", cells[c]),
               "lengths are in m, times in s, angles in rad", format("Convert it, and name it '{}'", names[bare]));
        const auto meant = nearest(cells[c], std::vector<std::string>(names.begin(), names.end()));
        fail(format("'{}' is no column of grains", cells[c]),
             "they are x, y, radius, vx, vy, spin, angle, density, group",
             meant ? format("Did you mean '{}'?", *meant) : "Name the columns in the first row");
      }
      std::size_t& at = at_[column];
      if (at != width_) fail(format("the column '{}' is there twice", names[column]), "", "Keep one");
      at = c;
    }
    for (const Column needed : {x, y, radius})
      if (at_[needed] == width_)
        fail(format("the column '{}' is missing", names[needed]), "every grain has a place and a size", "Add it");
  }

  [[nodiscard]] double number(const std::vector<std::string_view>& cells, Column column, double otherwise) const {
    if (at_[column] == width_) return otherwise;
    std::string_view cell = cells[at_[column]];
    if (cell.size() > 1 && cell.front() == '+' && cell[1] != '-') cell.remove_prefix(1);
    double value = 0;
    const auto [end, problem] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (problem != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
      fail(format("'{}' is no {}", cell, names[column]), "a finite number is needed", "Correct it");
    return value;
  }

  void read_grain(std::string_view row, std::optional<double> common_density, GrainBodies& bodies) const {
    const auto cells = cells_of(row);
    if (cells.size() != width_)
      fail(format("the row has {}", counted(static_cast<long long>(cells.size()), "cell")),
           format("the first row names {}", counted(static_cast<long long>(width_), "column")), "Correct it");
    Grain grain{.position = {number(cells, x, 0), number(cells, y, 0)},
                .radius = number(cells, radius, 0),
                .inertia = {},
                .velocity = {number(cells, vx, 0), number(cells, vy, 0)},
                .spin = number(cells, spin, 0),
                .angle = number(cells, angle, 0),
                .kind = 0};
    if (!(grain.radius > 0)) fail(format("the radius {} is not positive", grain.radius), "", "Correct it");
    const double own = number(cells, density, common_density.value_or(0));
    if (!(own > 0)) {
      if (at_[density] != width_) fail(format("the density {} is not positive", own), "", "Correct it");
      fail("the density of the grains is missing", "motion needs their mass",
           "Add density = ... in kg/m³ to [grains], or a column of that name");
    }
    grain.inertia = inertia_of(grain.radius, own, bodies.body);
    bodies.grains.push_back(grain);
    bodies.densities.push_back(own);
    bodies.groups.push_back(group_of(cells));
    bodies.lines.push_back(line_);
  }

  [[nodiscard]] std::string group_of(const std::vector<std::string_view>& cells) const {
    if (at_[group] == width_ || cells[at_[group]].empty()) return "grains";
    const std::string_view name = cells[at_[group]];
    if (!is_plain_name(name))
      fail(format("'{}' cannot name a group", name), "it stands in tables", "Use letters, digits, '_' and '-' only");
    if (name == "walls")
      fail("a group of grains is called 'walls'", "the name stands for all walls", "Name it otherwise");
    return std::string(name);
  }

  fs::path path_;
  int line_ = 0;
  std::size_t width_ = 0;
  std::array<std::size_t, columns> at_{};
};

void read_grain_table(const TomlValue& table, std::optional<double> common_density, GrainBodies& bodies) {
  const std::optional<double> own = optional_number(table, "density");
  if (!own && !common_density) {
    fail_at(table, "grain.density", "the density is missing", "motion needs the mass of the grains",
            "Add density = ... in kg/m³ to [grains], or to each [[grain]]");
  }
  if (text(table, "group").empty())
    fail_at(*table.find("group"), "grain.group", "the name is empty", "a group is known by its name", "Name it");
  check_plain_name(*table.find("group"), "grain.group", "a group", "it stands in tables");
  Grain grain{.position = vector(table, "position"),
              .radius = number(table, "radius"),
              .inertia = {},
              .velocity = vector(table, "velocity"),
              .spin = number(table, "spin"),
              .angle = number(table, "angle"),
              .kind = 0};
  bodies.densities.push_back(own ? *own : *common_density);
  grain.inertia = inertia_of(grain.radius, bodies.densities.back(), bodies.body);
  bodies.grains.push_back(grain);
  bodies.groups.push_back(text(table, "group"));
}

}  // namespace

GrainBodies read_bodies(TomlValue& root, const fs::path& folder) {
  TomlValue& common = *root.find("grains");
  GrainBodies bodies;
  bodies.body = body_from(text(common, "body"));
  const std::optional<double> density = optional_number(common, "density");
  if (TomlValue* path = common.find("path")) {
    const fs::path file = opened(path->text, folder);
    try {
      GrainFile(file).read(density, bodies);
    } catch (const Error& error) {
      throw error.at(format("{}: grains.path", path->where()));
    }
    path->text = bodies.file = file.string();
  }
  for (const TomlValue& table : repeated(root, "grain")) read_grain_table(table, density, bodies);
  if (bodies.grains.empty()) {
    fail_at(root, "grain", "there are no grains", "something has to move",
            "Add [[grain]] with position and radius, or [grains] with path");
  }
  return bodies;
}

}  // namespace equidem
