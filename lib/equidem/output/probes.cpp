// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/probes.hpp"

#include <cassert>
#include <charconv>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/energy_terms.hpp"

namespace equidem {
namespace {

constexpr std::size_t written_at_once = 1 << 16;  // bytes

void check(const std::vector<Probe>& probes, std::size_t discs) {
  std::set<std::string> names;
  for (const Probe& probe : probes) {
    if (probe.name.empty()) bad_input("a probe has no name", "its columns are found by it", "Name it");
    if (!names.insert(probe.name).second) {
      bad_input(format("two probes are called '{}'", probe.name), "columns are found by their names",
                "Rename one of them");
    }
    if (probe.discs.empty()) {
      bad_input(format("the probe '{}' holds no disc", probe.name), "nothing has no mean", "Choose at least one disc");
    }
    for (const std::int32_t disc : probe.discs) {
      if (disc < 0 || static_cast<std::size_t>(disc) >= discs) {
        bad_input(format("the probe '{}' names disc {}", probe.name, disc),
                  format("the discs are 0 to {}", static_cast<long long>(discs) - 1), "Choose discs that are there");
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
    for (const EnergyTerm& term : energy_terms) columns.push_back(format("{}_J_per_m", term.name));
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

[[noreturn]] void cannot_continue(const std::filesystem::path& path, const std::string& why) {
  bad_input(format("cannot add rows to '{}'", path.string()), why,
            "Go on where the histories of this very run lie, or start it afresh under another name");
}

}  // namespace

ProbeQuantity probe_quantity_from(const std::string& name) {
  if (name == "displacement") return ProbeQuantity::displacement;
  if (name == "rotation") return ProbeQuantity::rotation;
  if (name == "velocity") return ProbeQuantity::velocity;
  if (name == "spin") return ProbeQuantity::spin;
  bad_input(format("'{}' is nothing that a probe measures", name), "",
            "Write \"displacement\", \"rotation\", \"velocity\" or \"spin\"");
}

ProbeWriter::ProbeWriter(std::filesystem::path path, std::vector<Probe> probes, std::size_t discs,
                         const ProbeOptions& options)
    : path_(std::move(path)),
      probes_(std::move(probes)),
      options_(options),
      columns_(columns_of(probes_, options.energy)),
      header_(CsvText(columns_).text()),
      rows_(columns_) {
  check(probes_, discs);
  check_writable(path_, options.overwrite || options.continue_after);
  if (options.continue_after) {
    go_on(*options.continue_after);
    return;
  }
  write_file(path_, header_, options.overwrite);
  file_.emplace(path_, OpenFile::Mode::update);
  end_ = header_.size();
}

ProbeWriter::~ProbeWriter() {
  try {
    flush();
  } catch (const Error&) {
  }
}

void ProbeWriter::record(std::int64_t step, double time, std::span<const DiscMotion> motions,
                         std::span<const DiscMotion> velocities, const EnergyLedger& ledger) {
  assert(step > last_step_);
  last_step_ = step;
  rows_.cell(step);
  rows_.cell(time);
  for (const Probe& probe : probes_) {
    const DiscMotion motion = mean_of(probe.discs, motions), velocity = mean_of(probe.discs, velocities);
    for (const ProbeQuantity quantity : probe.quantities) {
      const bool rates = quantity == ProbeQuantity::velocity || quantity == ProbeQuantity::spin;
      const DiscMotion& value = rates ? velocity : motion;
      if (quantity == ProbeQuantity::rotation || quantity == ProbeQuantity::spin) {
        rows_.cell(value.theta);
      } else {
        rows_.cell(value.u.x);
        rows_.cell(value.u.y);
      }
    }
  }
  if (options_.energy) {
    for (const EnergyTerm& term : energy_terms) rows_.cell(ledger.*term.value);
    rows_.cell(ledger.error());
  }
  rows_.end_row();
  if (rows_.text().size() >= written_at_once || since_flush_.seconds() >= options_.interval) flush();
}

void ProbeWriter::flush() {
  const auto rows = std::string_view(rows_.text()).substr(header_.size());
  file_->write_at(end_, std::as_bytes(std::span(rows)));
  end_ += rows.size();
  rows_ = CsvText(columns_);
  since_flush_.lap();
}

void ProbeWriter::sync() {
  flush();
  file_->sync();
}

/// Rows are kept up to the first that is later, or that is not whole.
void ProbeWriter::go_on(std::int64_t after) {
  const std::string text = read_file(path_);
  if (!text.starts_with(header_)) {
    cannot_continue(path_, format("its columns are '{}', not '{}'", text.substr(0, text.find('\n')),
                                  header_.substr(0, header_.size() - 1)));
  }
  end_ = header_.size();
  for (std::size_t end = text.find('\n', end_); end != std::string::npos; end = text.find('\n', end_)) {
    std::int64_t step = 0;
    const auto [rest, failed] = std::from_chars(text.data() + end_, text.data() + end, step);
    if (failed != std::errc() || *rest != ',' || step <= last_step_) {
      cannot_continue(path_, format("'{}' is no row of it", text.substr(end_, std::min<std::size_t>(end - end_, 40))));
    }
    if (step > after) break;
    last_step_ = step;
    end_ = end + 1;
  }
  file_.emplace(path_, OpenFile::Mode::update);
  file_->truncate(end_);
}

}  // namespace equidem
