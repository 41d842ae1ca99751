// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/grain_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Columns of a file of grains. The last two are text.
enum GrainColumn { x, y, radius, short_half_axis, vx, vy, spin, angle, density, discs, group, columns };
constexpr std::array<const char*, columns> column_names = {"x",    "y",     "radius",  "short_half_axis", "vx",   "vy",
                                                           "spin", "angle", "density", "discs",           "group"};
/// Columns that a run also writes, ignored by this reader.
constexpr std::array ignored = {"grain", "number", "mass_kg", "mass_kg_per_m"};

/// The columns of a packing that is periodic.
constexpr std::array period = {"period_x_m", "period_y_m"};

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
  while (c < columns && name != column_names[c] && name != with_units[c]) ++c;
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
  GrainFile(const std::filesystem::path& path, const std::optional<Vec2>& cell) : file_(path), cell_(cell) {}

  void read(std::optional<double> common_density, GrainShapes& shapes, GrainRows& bodies) {
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
      if (const auto at = std::find(period.begin(), period.end(), cells[c]); at != period.end()) {
        if (!cell_)
          file_.fail(fmt::format("the column '{}' says that these bodies were packed in a periodic cell", cells[c]),
                     "the case has none: those at its sides would lose their neighbours",
                     "Add [cell] of that size, pack with sides = \"walls\", or delete the columns of the period to let "
                     "them go as they lie");
        period_at_[static_cast<std::size_t>(at - period.begin())] = c;
        continue;
      }
      const std::size_t column = column_of(cells[c]);
      if (column == columns) {
        const std::size_t bare = column_of(cells[c].substr(0, cells[c].find('_')));
        if (bare != columns)
          file_.fail(fmt::format("the column '{}' is in a unit of its own", cells[c]),
                     "lengths are in m, times in s, angles in rad",
                     fmt::format("Convert it, and name it '{}'", column_names[bare]));
        const auto meant = nearest(cells[c], std::vector<std::string>(column_names.begin(), column_names.end()));
        file_.fail(
            fmt::format("'{}' is no column of grains", cells[c]),
            fmt::format("they are {}", joined(std::vector<std::string>(column_names.begin(), column_names.end()))),
            meant ? fmt::format("Did you mean '{}'?", *meant) : "Name the columns in the first row");
      }
      std::size_t& at = at_[column];
      if (at != width_) file_.fail(fmt::format("the column '{}' is there twice", column_names[column]), "", "Keep one");
      at = c;
    }
    for (const GrainColumn needed : {x, y, radius}) {
      if (at_[needed] != width_ || (needed == radius && at_[discs] != width_)) continue;
      file_.fail(fmt::format("the column '{}' is missing", column_names[needed]), "every grain has a place and a size",
                 "Add it");
    }
  }

  [[nodiscard]] double number(GrainColumn column, double otherwise) const {
    if (at_[column] == width_) return otherwise;
    std::string_view text = cell(column);
    if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
    const auto value = number_from<double>(text);
    if (!value || !std::isfinite(*value))
      file_.fail(fmt::format("'{}' is no {}", text, column_names[column]), "a finite number is needed", "Correct it");
    return *value;
  }

  /// The text of a cell; empty where the column is not there.
  [[nodiscard]] std::string_view cell(GrainColumn column) const {
    return at_[column] == width_ ? std::string_view() : file_.cells()[at_[column]];
  }

  void read_grain(std::optional<double> common_density, GrainShapes& shapes, GrainRows& bodies) const {
    if (const auto count = std::ssize(file_.cells()); static_cast<std::size_t>(count) != width_)
      file_.fail(fmt::format("the row has {}", counted(count, "cell")),
                 fmt::format("the first row names {}", counted(static_cast<long long>(width_), "column")),
                 "Correct it");
    check_period();
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

  /// Those who packed the bodies closed the gaps across the sides of their cell.
  void check_period() const {
    constexpr double tolerance = 1e-9;
    for (std::size_t k = 0; k < period.size(); ++k) {
      if (!period_at_[k]) continue;
      const std::string_view text = file_.cells()[*period_at_[k]];
      const double wanted = k == 0 ? cell_->x : cell_->y;
      const auto value = number_from<double>(text);
      if (value && std::abs(*value - wanted) <= tolerance * wanted) continue;
      file_.fail(fmt::format("these bodies were packed in a cell with {} = {} m", k == 0 ? "width" : "height", text),
                 fmt::format("[cell] has {} m", wanted), "Give [cell] that size, or delete the columns of the period");
    }
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
    if (!is_plain_name(name))
      file_.fail(fmt::format("'{}' cannot name a group", name), "it stands in tables",
                 "Use letters, digits, '_' and '-' only");
    if (name == "walls")
      file_.fail("a group of grains is called 'walls'", "the name stands for all walls", "Name it otherwise");
    return std::string(name);
  }

  TableFile file_;
  std::optional<Vec2> cell_;
  std::array<std::optional<std::size_t>, 2> period_at_{};  ///< columns
  std::size_t width_ = 0;
  std::array<std::size_t, columns> at_{};
};

}  // namespace

GrainRows read_grains(const std::filesystem::path& path, std::optional<double> density, GrainShapes& shapes,
                      const std::optional<Vec2>& cell) {
  GrainRows bodies;
  GrainFile(path, cell).read(density, shapes, bodies);
  return bodies;
}

}  // namespace equidem
