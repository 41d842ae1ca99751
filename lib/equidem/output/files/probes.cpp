// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/probes.hpp"

#include <algorithm>
#include <cassert>
#include <set>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/fields/coarse_fields.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/output/files/energies.hpp"
#include "equidem/output/files/wall_loads.hpp"
#include "equidem/output/run/cell_history.hpp"

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

std::vector<std::string> probe_columns(const std::vector<Probe>& probes, const ProbeOptions& options) {
  std::vector<std::string> columns{"step", "time_s"};
  for (const Probe& probe : probes) {
    for (const ProbeQuantity quantity : probe.quantities)
      for (const char* column : entry_of(quantity).columns)
        if (column != nullptr) columns.push_back(probe.name + column);
    if (probe.box) columns.push_back(probe.name + "_inside");
  }
  const std::set<std::string> taken(columns.begin(), columns.end());
  const auto add = [&](const char* owner, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      columns.push_back(name);
      if (!taken.contains(name)) continue;
      bad_input(fmt::format("a probe and {} both have the column '{}'", owner, name),
                "columns are found by their names", "Rename the probe");
    }
  };
  add("a wall", wall_columns(options.walls, options.family, options.body));
  if (options.cell) add("the cell", cell_columns());
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
  for (const double value : wall_cells(walls_, family_, walls)) cells.push_back(value);
  if (cell_)
    for (const double value : cell_cells(*cell)) cells.push_back(value);
  for (const double value : energy_cells(family_, ledger)) cells.push_back(value);
  table_.add(step, cells, regular);
}

}  // namespace equidem
