// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep/sweep_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

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

}  // namespace

Table sweep_table(const std::string& key, const std::vector<SweepPoint>& points) {
  Table table;
  table.add(key, points, &SweepPoint::value).add("status", points, &SweepPoint::status);
  for (const NumberColumn& column : number_columns) {
    table.add(column.name, points, [&](const SweepPoint& point) {
      return std::isnan(point.*column.member) ? std::nullopt : std::optional(point.*column.member);
    });
  }
  return table.add("message", points, &SweepPoint::message);
}

std::vector<SweepPoint> read_sweep_points(const std::filesystem::path& path, const std::string& key) {
  const StoredTable table(path, sweep_table(key, {}), "sweep",
                          "Remove the row, and it is computed again; or choose another --out, or leave out --resume");
  std::vector<SweepPoint> points(table.rows());
  for (std::size_t row = 0; row < points.size(); ++row) {
    SweepPoint& point = points[row];
    point.value = table.number(row, 0);
    point.status = table.text(row, 1);
    for (std::size_t c = 0; c < number_columns.size(); ++c) point.*number_columns[c].member = table.number(row, c + 2);
    point.message = table.text(row, number_columns.size() + 2);
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
