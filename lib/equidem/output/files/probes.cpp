// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/probes.hpp"

#include <set>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/energy_terms.hpp"

namespace equidem {
namespace {

void check(const std::vector<Probe>& probes, std::size_t discs) {
  std::set<std::string> names;
  for (const Probe& probe : probes) {
    if (probe.name.empty()) bad_input("a probe has no name", "its columns are found by it", "Name it");
    if (!names.insert(probe.name).second) {
      bad_input(fmt::format("two probes are called '{}'", probe.name), "columns are found by their names",
                "Rename one of them");
    }
    if (probe.discs.empty()) {
      bad_input(fmt::format("the probe '{}' holds no disc", probe.name), "nothing has no mean",
                "Choose at least one disc");
    }
    for (const std::int32_t disc : probe.discs) {
      if (disc < 0 || static_cast<std::size_t>(disc) >= discs) {
        bad_input(fmt::format("the probe '{}' names disc {}", probe.name, disc),
                  fmt::format("the discs are 0 to {}", static_cast<long long>(discs) - 1),
                  "Choose discs that are there");
      }
    }
  }
}

std::vector<std::string> columns_of(const std::vector<Probe>& probes, bool energy) {
  std::vector<std::string> columns{"step", "time_s"};
  for (const Probe& probe : probes) {
    for (const ProbeQuantity quantity : probe.quantities) {
      switch (quantity) {
        case ProbeQuantity::displacement:
          columns.insert(columns.end(), {probe.name + "_ux_m", probe.name + "_uy_m"});
          break;
        case ProbeQuantity::rotation:
          columns.push_back(probe.name + "_rotation_rad");
          break;
        case ProbeQuantity::velocity:
          columns.insert(columns.end(), {probe.name + "_vx_m_per_s", probe.name + "_vy_m_per_s"});
          break;
        case ProbeQuantity::spin:
          columns.push_back(probe.name + "_spin_rad_per_s");
          break;
      }
    }
  }
  if (energy) {
    for (const EnergyTerm& term : energy_terms) columns.push_back(fmt::format("{}_J_per_m", term.name));
    columns.emplace_back("error_J_per_m");
  }
  return columns;
}

DiscMotion mean_of(const std::vector<std::int32_t>& discs, std::span<const DiscMotion> values) {
  DiscMotion sum;
  for (const std::int32_t disc : discs) {
    sum.u += values[static_cast<std::size_t>(disc)].u;
    sum.theta += values[static_cast<std::size_t>(disc)].theta;
  }
  const auto count = static_cast<double>(discs.size());
  return {sum.u / count, sum.theta / count};
}

std::vector<Probe> checked(std::vector<Probe> probes, std::size_t discs) {
  check(probes, discs);
  return probes;
}

}  // namespace

ProbeWriter::ProbeWriter(std::filesystem::path path, std::vector<Probe> probes, std::size_t discs,
                         const ProbeOptions& options)
    : probes_(checked(std::move(probes), discs)),
      energy_(options.energy),
      table_(std::move(path), columns_of(probes_, options.energy),
             {.interval = options.interval, .overwrite = options.overwrite, .continue_after = options.continue_after}) {
}

void ProbeWriter::record(std::int64_t step, double time, std::span<const DiscMotion> motions,
                         std::span<const DiscMotion> velocities, const EnergyLedger& ledger) {
  std::vector<double> cells = {time};
  for (const Probe& probe : probes_) {
    const DiscMotion motion = mean_of(probe.discs, motions), velocity = mean_of(probe.discs, velocities);
    for (const ProbeQuantity quantity : probe.quantities) {
      const bool rates = quantity == ProbeQuantity::velocity || quantity == ProbeQuantity::spin;
      const DiscMotion& value = rates ? velocity : motion;
      if (quantity == ProbeQuantity::rotation || quantity == ProbeQuantity::spin) {
        cells.push_back(value.theta);
      } else {
        cells.push_back(value.u.x);
        cells.push_back(value.u.y);
      }
    }
  }
  if (energy_) {
    for (const EnergyTerm& term : energy_terms) cells.push_back(ledger.*term.value);
    cells.push_back(ledger.error());
  }
  table_.add(step, cells);
}

}  // namespace equidem
