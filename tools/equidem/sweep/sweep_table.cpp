// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep/sweep_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

#include "csv_cells.hpp"

namespace equidem {
namespace {

struct NumberColumn {
  const char* name;
  double SweepPoint::*member;
};

constexpr std::array number_columns{
    NumberColumn{"poisson_ratio", &SweepPoint::poisson_ratio},
    NumberColumn{"stiffness_ratio", &SweepPoint::stiffness_ratio},
    NumberColumn{"theory_poisson_ratio", &SweepPoint::theory_poisson_ratio},
    NumberColumn{"theory_stiffness_ratio", &SweepPoint::theory_stiffness_ratio},
    NumberColumn{"energy", &SweepPoint::energy},
    NumberColumn{"relative_residual", &SweepPoint::relative_residual},
    NumberColumn{"negative_pivots", &SweepPoint::negative_pivots},
    NumberColumn{"unstable_modes", &SweepPoint::unstable_modes},
};

std::vector<std::string> column_names(const std::string& key) {
  std::vector<std::string> names{key, "status"};
  for (const NumberColumn& column : number_columns) names.emplace_back(column.name);
  names.emplace_back("message");
  return names;
}

std::string shown(double value) {
  return std::isnan(value) ? "-" : fmt::format("{:.8g}", value);
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

JsonObject sweep_json(const std::string& key, const SweepPoint& point) {
  JsonObject object;
  object.set(key, point.value).set("status", point.status);
  for (const NumberColumn& column : number_columns) object.set(column.name, point.*column.member);
  if (!point.message.empty()) object.set("message", point.message);
  return object;
}

std::string describe_sweep(const std::string& key, const std::vector<SweepPoint>& points) {
  const bool tension =
      std::any_of(points.begin(), points.end(), [](const SweepPoint& p) { return !std::isnan(p.poisson_ratio); });
  const auto moduli = [&](const auto& nu, const auto& nu_theory, const auto& stiffness, const auto& stiffness_theory) {
    return tension ? fmt::format("{:>14} {:>14} {:>14} {:>14} ", nu, nu_theory, stiffness, stiffness_theory)
                   : std::string();
  };
  std::string out = fmt::format("{:>14}  {:<8} {}{:>14}  {:>9} {:>9}\n", key, "status",
                                moduli("nu", "theory", "2G/((1-nu)kN)", "theory"), "energy, N", "residual", "unstable");
  for (const SweepPoint& p : points) {
    out += fmt::format("{:>14.8g}  {:<8} ", p.value, p.status);
    if (p.status == "failed") {
      out += p.message + "\n";
      continue;
    }
    out += moduli(shown(p.poisson_ratio), shown(p.theory_poisson_ratio), shown(p.stiffness_ratio),
                  shown(p.theory_stiffness_ratio));
    out += fmt::format("{:>14}  {:>9.1e} {:>9}\n", shown(p.energy), p.relative_residual, shown(p.unstable_modes));
  }
  return out;
}

}  // namespace equidem
