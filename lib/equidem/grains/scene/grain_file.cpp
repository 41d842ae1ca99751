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
constexpr std::array<std::optional<Dimension>, columns> quantities = {
    Dimension::length, Dimension::length, Dimension::length,  Dimension::length, Dimension::speed, Dimension::speed,
    Dimension::spin,   Dimension::angle,  Dimension::density, Dimension::length, std::nullopt};
/// Columns that a run also writes, ignored by this reader.
constexpr std::array ignored = {"grain", "number", "mass"};

/// The columns of a packing that is periodic.
constexpr std::array period = {"period_x", "period_y"};

/// "x y r; x y r": the discs of a clump in one cell of a table.
/// \param unit m
/// \throws Error (bad_input) where the text is something else
std::vector<Clump::Disc> clump_from(std::string_view text, double unit) {
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
    discs.push_back({{unit * numbers[0], unit * numbers[1]}, unit * numbers[2]});
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
  GrainFile(const std::filesystem::path& path, const std::optional<Vec2>& cell)
      : file_(path, {{"x"}, {"y"}}), cell_(cell) {}

  void read(std::optional<double> common_density, GrainShapes& shapes, GrainRows& bodies) {
    if (file_.names().empty())
      file_.fail("the file has no row of names", "x, y and radius are needed", "Begin it with x,y,radius");
    read_heading();
    while (file_.next()) read_grain(common_density, shapes, bodies);
  }

 private:
  void read_heading() {
    for (const ColumnName& name : file_.names()) check_name(name);
    for (std::size_t k = 0; k < period.size(); ++k) period_at_[k] = file_.find({period[k]});
    for (std::size_t c = 0; c < columns; ++c) {
      at_[c] = file_.find({column_names[c]});
      if (!at_[c]) continue;
      const auto factor = file_.factor(*at_[c], quantities[c]);
      units_[c] = factor.value_or(1);
    }
    for (const GrainColumn needed : {x, y, radius}) {
      if (at_[needed] || (needed == radius && at_[discs])) continue;
      file_.fail_at_names(fmt::format("the column '{}' is missing", column_names[needed]),
                          "every grain has a place and a size", "Add it");
    }
    check_units_of_lengths();
  }

  void check_name(const ColumnName& column) const {
    const auto is_name = [&](const char* name) { return column.name == name; };
    if (column.text.empty() || std::ranges::any_of(ignored, is_name)) return;
    if (std::ranges::any_of(period, is_name)) {
      if (cell_) return;
      file_.fail_at_names(
          fmt::format("the column '{}' says that these bodies were packed in a periodic cell", column.text),
          "the case has none: those at its sides would lose their neighbours",
          "Add [cell] of that size, pack with sides = \"walls\", or delete the columns of the period to let them go as "
          "they lie");
    }
    if (std::ranges::any_of(column_names, is_name)) return;
    const std::string bare = column.name.substr(0, column.name.find('_'));
    if (std::ranges::find(column_names, bare) != column_names.end())
      file_.fail_at_names(fmt::format("the column '{}' is in a unit of its own", column.text),
                          "lengths are in m, mm or um, times in s, angles in rad",
                          fmt::format("Convert it, and name it '{}'", bare));
    const std::vector<std::string> known(column_names.begin(), column_names.end());
    const auto meant = nearest(column.text, known);
    file_.fail_at_names(fmt::format("'{}' is no column of grains", column.text),
                        fmt::format("they are {}", joined(known)),
                        meant ? fmt::format("Did you mean '{}'?", *meant) : "Name the columns in the first row");
  }

  /// Lengths without a unit are in m; beside one in mm they may not be meant so.
  void check_units_of_lengths() const {
    const auto is_length = [&](std::size_t c) { return at_[c] && quantities[c] == Dimension::length; };
    for (std::size_t c = 0; c < columns; ++c) {
      if (!is_length(c) || units_[c] == 1) continue;
      for (std::size_t other = 0; other < columns; ++other) {
        if (!is_length(other) || !file_.names()[*at_[other]].unit.empty()) continue;
        file_.fail_at_names(
            fmt::format("the column '{}' says no unit, and '{}' one", column_names[other], file_.names()[*at_[c]].text),
            "it may be in that unit, too, or in m",
            fmt::format("Name it '{}_m', or with its unit", column_names[other]));
      }
    }
  }

  [[nodiscard]] double number(GrainColumn column, double otherwise) const {
    return at_[column] ? units_[column] * file_.number(*at_[column], column_names[column]) : otherwise;
  }

  /// The text of a cell; empty where the column is not there.
  [[nodiscard]] std::string_view cell(GrainColumn column) const {
    return at_[column] ? file_.cells()[*at_[column]] : std::string_view();
  }

  void read_grain(std::optional<double> common_density, GrainShapes& shapes, GrainRows& bodies) const {
    check_period();
    Grain grain;
    grain.position = {number(x, 0), number(y, 0)};
    grain.velocity = {number(vx, 0), number(vy, 0)};
    grain.spin = number(spin, 0);
    grain.angle = number(angle, 0);
    const double own = number(density, common_density.value_or(0));
    if (!(own > 0)) {
      if (at_[density]) file_.fail(fmt::format("the density {} is not positive", own), "", "Correct it");
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
      const double wanted = k == 0 ? cell_->x : cell_->y;
      const double value = file_.factor(*period_at_[k], Dimension::length).value_or(1) * file_.number(*period_at_[k]);
      if (std::abs(value - wanted) <= tolerance * wanted) continue;
      file_.fail(fmt::format("these bodies were packed in a cell with {} = {} m", k == 0 ? "width" : "height", value),
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
    shapes.make_clump(grain, clump_from(cell(discs), units_[discs]), own_density);
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
  std::array<std::optional<std::size_t>, columns> at_{};
  std::array<double, columns> units_{};
};

}  // namespace

GrainRows read_grains(const std::filesystem::path& path, std::optional<double> density, GrainShapes& shapes,
                      const std::optional<Vec2>& cell) {
  GrainRows bodies;
  GrainFile(path, cell).read(density, shapes, bodies);
  return bodies;
}

namespace {

constexpr auto as_springs = "back to the distance at the start, and across it; 0 in the thesis: bonds creep",
               as_dashpots =
                   "C_n along the line of centres, where a pair stops as exp(-C_n t/m), m the reduced mass, and a "
                   "steady pull N makes it creep at N/C_n; C_s across it, at the point of the bond: no friction limits "
                   "it";
constexpr BondProperty properties_of_bonds[] = {
    {"normal_dashpot", &GrainBond::normal_dashpot, "N s/m (discs: per m of depth)", as_dashpots},
    {"tangential_dashpot", &GrainBond::tangential_dashpot, "N s/m (discs: per m of depth)", as_dashpots},
    {"rolling_dashpot", &GrainBond::rolling_dashpot, "N m s",
     "against the relative spin; 0 in the thesis: discs roll freely on one another"},
    {"normal_spring", &GrainBond::normal_spring, "N/m (discs: per m of depth)", as_springs},
    {"tangential_spring", &GrainBond::tangential_spring, "N/m (discs: per m of depth)", as_springs},
    {"bending_spring", &GrainBond::bending_spring, "N m (discs: per m of depth)",
     "kM, moment by the rotation of one disc against the other; a parallel bond of width w has normal_spring w²/12"},
};

/// Columns that a run writes and this reader passes over.
constexpr std::array others = {"distance_drift", "slip_drift", "roll"};

std::size_t grain_number(std::size_t column, const TableFile& file) {
  const auto number = number_from<std::size_t>(file.cells()[column]);
  if (!number)
    file.fail(fmt::format("'{}' is no number of a grain", file.cells()[column]), "grains are counted 0, 1, 2, ...",
              "Correct it");
  return *number;
}

/// A name that is nearly one of those that are read is taken for a typing error: its bonds would never break.
void refuse_near_names(const TableFile& file) {
  std::vector<std::string> known = names_in(properties_of_bonds);
  known.insert(known.end(), {"tension", "shear"});
  for (const ColumnName& column : file.names()) {
    const auto is_name = [&](const std::string& name) { return column.name == name; };
    if (std::ranges::any_of(others, is_name) || column.name.size() < 4) continue;
    const auto with_unit = std::ranges::find_if(known, [&](const std::string& name) {
      return column.name.starts_with(name + "_") || (column.name == name && !column.unit.empty());
    });
    if (with_unit != known.end())
      file.fail_at_names(fmt::format("the column '{}' is in a unit of its own", column.text),
                         "springs and strengths are in N/m, dashpots in N s/m",
                         fmt::format("Convert it, and name it '{}'", *with_unit));
    if (std::ranges::any_of(known, is_name)) continue;
    if (const auto meant = nearest(column.name, known))
      file.fail_at_names(fmt::format("there is no column '{}' of bonds", column.text), "it is nearly one that is read",
                         fmt::format("Did you mean '{}'?", *meant));
  }
}

}  // namespace

std::span<const BondProperty> bond_properties() {
  return properties_of_bonds;
}

BondRows read_bonds(const std::filesystem::path& path, const GrainBond& common) {
  struct Column {
    std::size_t place;
    std::string_view name;
    double GrainBond::*property;
    std::optional<double> BondRows::Strength::*strength;
  };
  BondRows result;
  TableFile file(path, {{"i"}, {"j"}});
  if (file.width() == 0) return result;
  const auto i = file.find({"i"}), j = file.find({"j"});
  if (!i || !j)
    file.fail_at_names("there are no columns i and j", "they say which grains are tied", "Begin the file with i,j");
  refuse_near_names(file);
  std::vector<Column> columns;
  for (const BondProperty& property : properties_of_bonds)
    if (const auto place = file.find({property.name}))
      columns.push_back({*place, property.name, property.value, nullptr});
  if (const auto place = file.find({"tension"}))
    columns.push_back({*place, "tension", nullptr, &BondRows::Strength::tension});
  if (const auto place = file.find({"shear"}))
    columns.push_back({*place, "shear", nullptr, &BondRows::Strength::shear});
  while (file.next()) {
    GrainBond bond = common;
    BondRows::Strength own;
    bond.i = grain_number(*i, file);
    bond.j = grain_number(*j, file);
    for (const Column& column : columns) {
      if (file.cells()[column.place].empty()) continue;
      const double value = file.number(column.place, column.name);
      if (value < 0)
        file.fail(fmt::format("'{}' is no {}", file.cells()[column.place], column.name), "a number >= 0 is needed",
                  "Correct it");
      if (column.strength != nullptr)
        own.*column.strength = value;
      else
        bond.*column.property = value;
    }
    result.strengths.push_back(own);
    result.bonds.push_back(bond);
    result.places.push_back(file.where());
  }
  return result;
}

}  // namespace equidem
