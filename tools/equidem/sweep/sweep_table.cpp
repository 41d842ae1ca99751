// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep/sweep_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {
namespace {

struct NumberColumn {
  const char* name;
  double SweepPoint::*member;
  const char* label;  ///< in the report; empty: left out
  const char* unit = "";
  Shown shown = {.digits = 8};
  bool of_tension = false;
};

constexpr std::array number_columns{
    NumberColumn{.name = "poisson_ratio", .member = &SweepPoint::poisson_ratio, .label = "nu", .of_tension = true},
    NumberColumn{.name = "stiffness_ratio",
                 .member = &SweepPoint::stiffness_ratio,
                 .label = "2G/((1-nu)kN)",
                 .of_tension = true},
    NumberColumn{.name = "theory_poisson_ratio",
                 .member = &SweepPoint::theory_poisson_ratio,
                 .label = "nu theory",
                 .of_tension = true},
    NumberColumn{.name = "theory_stiffness_ratio",
                 .member = &SweepPoint::theory_stiffness_ratio,
                 .label = "2G/((1-nu)kN) theory",
                 .of_tension = true},
    NumberColumn{.name = "energy", .member = &SweepPoint::energy, .label = "energy", .unit = "N"},
    NumberColumn{.name = "relative_residual",
                 .member = &SweepPoint::relative_residual,
                 .label = "residual",
                 .shown = {Shown::power, 1}},
    NumberColumn{.name = "negative_pivots", .member = &SweepPoint::negative_pivots, .label = ""},
    NumberColumn{.name = "unstable_modes", .member = &SweepPoint::unstable_modes, .label = "unstable"},
};

std::vector<std::string> column_names(const std::string& key) {
  std::vector<std::string> names{key, "status"};
  for (const NumberColumn& column : number_columns) names.emplace_back(column.name);
  names.emplace_back("message");
  return names;
}

}  // namespace

std::string sweep_csv(const std::string& key, const std::vector<SweepPoint>& points) {
  CsvText csv(column_names(key), points.size());
  for (const SweepPoint& point : points) {
    csv.cell(point.value);
    csv.cell(std::string_view(point.status));
    for (const NumberColumn& column : number_columns) {
      if (std::isnan(point.*column.member))
        csv.empty_cell();
      else
        csv.cell(point.*column.member);
    }
    csv.cell(std::string_view(point.message));
    csv.end_row();
  }
  return csv.text();
}

std::vector<SweepPoint> read_sweep_csv(const std::filesystem::path& path, const std::string& key) {
  const auto rows = csv_cells(read_file(path));
  const auto names = column_names(key);
  if (rows.empty() || rows.front() != names) {
    throw Error(ErrorKind::bad_input, "this is not the table of the sweep to continue",
                fmt::format("its columns are not those of a sweep of {}", key),
                "Choose another --out, or leave out --resume", path.string());
  }
  std::vector<SweepPoint> points;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const auto fail = [&]() {
      throw Error(ErrorKind::bad_input, "this row is damaged",
                  "a sweep writes a number or nothing in each of its columns",
                  "Remove the row, and it is computed again", fmt::format("{}:{}", path.string(), k + 1));
    };
    if (rows[k].size() != names.size()) fail();
    SweepPoint point;
    const auto value = csv_number(rows[k][0]);
    if (!value || std::isnan(*value)) fail();
    point.value = *value;
    point.status = rows[k][1];
    for (std::size_t c = 0; c < number_columns.size(); ++c) {
      const auto number = csv_number(rows[k][c + 2]);
      if (!number) fail();
      point.*number_columns[c].member = *number;
    }
    point.message = rows[k].back();
    points.push_back(std::move(point));
  }
  return points;
}

std::vector<Results> sweep_rows(const std::string& key, const std::vector<SweepPoint>& points) {
  const bool tension = std::ranges::any_of(points, [](const SweepPoint& p) { return !std::isnan(p.poisson_ratio); });
  std::vector<Results> rows;
  for (const SweepPoint& point : points) {
    Results row;
    row.add("value", key, point.value, "", {.digits = 8}).add("status", "status", point.status);
    for (const NumberColumn& column : number_columns) {
      const bool shown = *column.label != '\0' && (tension || !column.of_tension) && point.status != "failed";
      shown ? row.add(column.name, column.label, point.*column.member, column.unit, column.shown)
            : row.set(column.name, point.*column.member);
    }
    if (!point.message.empty()) row.set("message", point.message).note(point.message);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace equidem
