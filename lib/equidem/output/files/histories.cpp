// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/histories.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/fields/box_measures.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {
namespace {

void check(const std::vector<Probe>& probes, std::size_t bodies) {
  std::set<std::string> names;
  for (const Probe& probe : probes) {
    if (probe.name.empty()) bad_input("a probe has no name", "its columns are found by it", "Name it");
    if (!names.insert(probe.name).second) {
      bad_input(fmt::format("two probes are called '{}'", probe.name), "columns are found by their names",
                "Rename one of them");
    }
    if (probe.bodies.empty()) {
      bad_input(fmt::format("the probe '{}' holds no body", probe.name), "nothing has no mean",
                "Choose at least one body");
    }
    if (has_stress(probe) && !probe.box) {
      bad_input(fmt::format("the probe '{}' has a stress and no box", probe.name), "a stress is the mean over an area",
                "Give it a box");
    }
    for (const std::int32_t body : probe.bodies) {
      if (body < 0 || static_cast<std::size_t>(body) >= bodies) {
        bad_input(fmt::format("the probe '{}' names body {}", probe.name, body),
                  fmt::format("the bodies are 0 to {}", static_cast<long long>(bodies) - 1),
                  "Choose bodies that are there");
      }
    }
  }
}

/// A number of a state, as a column of a history.
template <class State>
struct Column {
  const char* name;
  double (*value)(const State&);
  bool per_depth = false;  ///< of discs
  bool summed = false;     ///< since the start, of colliding bodies alone

  [[nodiscard]] bool is_written(BodyFamily family) const { return family == BodyFamily::colliding || !summed; }
};

constexpr Column<WallState> wall_quantities[] = {
    {"x_m", [](const WallState& w) { return w.place.x; }},
    {"y_m", [](const WallState& w) { return w.place.y; }},
    {"vx_m_per_s", [](const WallState& w) { return w.velocity.x; }},
    {"vy_m_per_s", [](const WallState& w) { return w.velocity.y; }},
    {"force_x_N", [](const WallState& w) { return w.force.x; }, true},
    {"force_y_N", [](const WallState& w) { return w.force.y; }, true},
    {"moment_N_m", [](const WallState& w) { return w.moment; }, true},
    {"impulse_x_N_s", [](const WallState& w) { return w.impulse.x; }, true, true},
    {"impulse_y_N_s", [](const WallState& w) { return w.impulse.y; }, true, true},
    {"work_J", [](const WallState& w) { return w.work; }, true, true},
};

constexpr Column<CellState> cell_quantities[] = {
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

std::vector<std::string> probe_columns(const std::vector<Probe>& probes, const ProbeOptions& options) {
  std::vector<std::string> columns{"step", "time_s"};
  for (const Probe& probe : probes) {
    for (const ProbeQuantity quantity : probe.quantities)
      for (const char* column : entry_of(quantity).columns)
        if (column != nullptr) columns.push_back(probe.name + column);
    if (probe.box) columns.push_back(probe.name + "_inside");
  }
  const std::set<std::string> taken(columns.begin(), columns.end());
  const auto add = [&](const char* owner, const std::string& name) {
    columns.push_back(name);
    if (taken.contains(name))
      bad_input(fmt::format("a probe and {} both have the column '{}'", owner, name),
                "columns are found by their names", "Rename the probe");
  };
  for (const std::string& wall : options.walls)
    for (const auto& column : wall_quantities)
      if (column.is_written(options.family))
        add("a wall", fmt::format("wall_{}_{}{}", wall, column.name, column.per_depth ? per_depth(options.body) : ""));
  for (const auto& column : cell_quantities)
    if (options.cell) add("the cell", column.name);
  for (const std::string& name : energy_columns(options.family, options.body)) columns.push_back(name);
  return columns;
}

/// Over the bodies that are there; not_there where none is.
DiscMotion mean_of(const std::vector<std::int32_t>& bodies, std::span<const DiscMotion> values) {
  DiscMotion sum;
  double count = 0;
  for (const std::int32_t body : bodies) {
    const DiscMotion& value = values[static_cast<std::size_t>(body)];
    if (!is_there(value)) continue;
    sum.u += value.u;
    sum.theta += value.theta;
    count += 1;
  }
  return count > 0 ? DiscMotion{sum.u / count, sum.theta / count} : not_there;
}

/// Number of the bodies with their centre in a box, its sides included.
double count_inside(const Probe& probe, std::span<const DiscMotion> positions) {
  return static_cast<double>(std::ranges::count_if(probe.bodies, [&](std::int32_t body) {
    const Vec2 centre = positions[static_cast<std::size_t>(body)].u;
    return probe.box->low.x <= centre.x && centre.x <= probe.box->high.x && probe.box->low.y <= centre.y &&
           centre.y <= probe.box->high.y;
  }));
}

std::vector<Probe> checked(std::vector<Probe> probes, std::size_t bodies) {
  check(probes, bodies);
  return probes;
}

}  // namespace

ProbeWriter::ProbeWriter(std::filesystem::path path, std::vector<Probe> probes, std::size_t bodies,
                         const ProbeOptions& options)
    : probes_(checked(std::move(probes), bodies)),
      family_(options.family),
      walls_(options.walls),
      cell_(options.cell),
      table_(std::move(path), probe_columns(probes_, options),
             {.interval = options.interval, .overwrite = options.overwrite, .continue_from = options.continue_from}) {}

void ProbeWriter::record(std::int64_t step, double time, std::span<const DiscMotion> motions,
                         std::span<const DiscMotion> velocities, std::span<const WallState> walls,
                         const EnergyLedger& ledger, bool regular, const std::optional<CellState>& cell,
                         std::span<const BodyContact> contacts) {
  assert(cell.has_value() == cell_);
  std::vector<double> cells = {time};
  for (const Probe& probe : probes_) {
    const DiscMotion motion = mean_of(probe.bodies, motions), velocity = mean_of(probe.bodies, velocities);
    for (const ProbeQuantity quantity : probe.quantities) {
      if (quantity == ProbeQuantity::stress) {
        const Tensor2 stress = region_stress(*probe.box, probe.bodies, motions, contacts);
        cells.insert(cells.end(), {stress.xx, stress.xy, stress.yx, stress.yy});
        continue;
      }
      const ProbeQuantityFacts& facts = entry_of(quantity);
      const DiscMotion& value = facts.rate ? velocity : motion;
      if (facts.columns[1] == nullptr) {
        cells.push_back(value.theta);
      } else {
        cells.insert(cells.end(), {value.u.x, value.u.y});
      }
    }
    if (probe.box) cells.push_back(count_inside(probe, motions));
  }
  for (const std::string& name : walls_) {
    const auto found = std::ranges::find(walls, name, &WallState::name);
    for (const auto& column : wall_quantities)
      if (column.is_written(family_)) cells.push_back(found == walls.end() ? NAN : column.value(*found));
  }
  for (const auto& column : cell_quantities)
    if (cell_) cells.push_back(column.value(*cell));
  for (const double value : energy_cells(family_, ledger)) cells.push_back(value);
  table_.add(step, cells, regular);
}

std::vector<std::string> energy_columns(BodyFamily family, Body body) {
  std::vector<std::string> columns;
  for (const EnergyTerm& term : energy_terms(family))
    columns.push_back(fmt::format("{}_J{}", term.key, per_depth(body)));
  columns.push_back(fmt::format("error_J{}", per_depth(body)));
  return columns;
}

std::vector<double> energy_cells(BodyFamily family, const EnergyLedger& ledger) {
  std::vector<double> cells;
  for (const EnergyTerm& term : energy_terms(family)) cells.push_back(ledger.*term.value);
  cells.push_back(ledger.error());
  return cells;
}

void write_energy_csv(const std::filesystem::path& path, std::span<const EnergySample> energies, BodyFamily family,
                      Body body, bool overwrite) {
  std::vector<std::string> columns{"step", "time_s"};
  for (const std::string& name : energy_columns(family, body)) columns.push_back(name);
  const auto make = [&](const TextSink& to) {
    CsvText text(columns);
    for (const EnergySample& sample : energies) {
      text.cell(sample.step);
      text.cell(sample.time);
      for (const double value : energy_cells(family, sample.ledger)) text.cell(value);
      text.end_row();
      text.pass_on(to, false);
    }
    text.pass_on(to, true);
  };
  write_file(path, make, overwrite);
}

Results energy_results(BodyFamily family, Body body, const EnergyLedger& ledger, double scale) {
  const char* unit = body == Body::disc ? "J/m" : "J";
  Results energy;
  for (const EnergyTerm& term : energy_terms(family)) {
    const char* what = term.role == EnergyRole::lost ? "lost by " : term.role == EnergyRole::work ? "work of " : "";
    energy.set(term.key, ledger.*term.value, unit, fmt::format("energy: {}{}", what, term.label));
  }
  return energy.set("elastic", ledger.elastic(), unit, "energy: elastic")
      .set("dissipated", ledger.lost(), unit, "energy: lost in all")
      .set("input", ledger.work(), unit, "energy: work done on the bodies")
      .set("error", ledger.error(), unit, "energy: error of the balance")
      .set("relative_error", scale > 0 ? ledger.error() / scale : 0.0, "",
           "energy: error of the balance, relative to the largest term");
}

Results wall_results(std::span<const WallState> walls, BodyFamily family, Body body) {
  const bool disc = body == Body::disc, summed = family == BodyFamily::colliding;
  const char *force = disc ? "N/m" : "N", *moment = disc ? "N" : "N m", *impulse = disc ? "N s/m" : "N s",
             *work = disc ? "J/m" : "J";
  std::vector<Results> rows;
  for (const WallState& wall : walls) {
    Results& row = rows.emplace_back();
    row.add("name", "wall", wall.name)
        .set("place", wall.place, "m", "place of a wall")
        .set("force", wall.force, force, "force of the bodies on a wall, mean over the last step")
        .set("moment", wall.moment, moment, "moment of this force about the place of the wall");
    row.add("", fmt::format("force x, {}", force), wall.force.x).add("", "force y", wall.force.y);
    row.add("", fmt::format("moment, {}", moment), wall.moment);
    row.add("", "at x, m", wall.place.x).add("", "at y", wall.place.y);
    if (!summed) continue;
    row.set("impulse", wall.impulse, impulse, "impulse of the bodies on a wall since the start")
        .set("work", wall.work, work, "work of a wall since the start")
        .add("", fmt::format("work, {}", work), wall.work);
  }
  Results out;
  if (rows.empty()) return out.set("forces_on_walls", std::move(rows));
  out.line("walls", fmt::format("forces on them in the last step, moments about their places{}:",
                                summed ? ", works since the start" : ""));
  return out.table("forces_on_walls", std::move(rows));
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
