// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Histories: how chosen discs and the energies change with time, as CSV.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/contact/frame.hpp"
#include "equidem/core/names.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/output/files/growing_csv.hpp"

namespace equidem {

enum class ProbeQuantity { displacement, rotation, velocity, spin };
template <>
struct EnumNames<ProbeQuantity> {
  static constexpr const char* what = "quantity of a probe";
  static constexpr NamedValue<ProbeQuantity> list[] = {{ProbeQuantity::displacement, "displacement"},
                                                       {ProbeQuantity::rotation, "rotation"},
                                                       {ProbeQuantity::velocity, "velocity"},
                                                       {ProbeQuantity::spin, "spin"}};
};

/// The mean of some discs.
struct Probe {
  std::string name;                 ///< begins the names of its columns
  std::vector<std::int32_t> discs;  ///< at least one
  std::vector<ProbeQuantity> quantities = {ProbeQuantity::displacement};
};

struct ProbeOptions {
  bool energy = true;      ///< the energy ledger too
  double interval = 5;     ///< s of the clock on the wall between two writes; 64 KiB of rows are written at once
  bool overwrite = false;  ///< a file of that name
  /// Go on with the file of an earlier run: rows later than this step, and a row cut short, are dropped.
  std::optional<std::int64_t> continue_after = {};
};

/// Writes rows: step, time_s; for every probe what it asks for: NAME_ux_m, NAME_uy_m; NAME_rotation_rad;
/// NAME_vx_m_per_s, NAME_vy_m_per_s; NAME_spin_rad_per_s; then every term of the ledger, TERM_J_per_m, and
/// error_J_per_m, what its balance lacks.
class ProbeWriter {
 public:
  /// \param discs of the assembly
  /// \throws Error (bad_input) where two probes share a name or one has no disc or one that is not there, where the
  ///         file
  ///         exists and neither `overwrite` nor `continue_after` is set, where it cannot be written, or where the file
  ///         to go on with has other columns
  ProbeWriter(std::filesystem::path path, std::vector<Probe> probes, std::size_t discs, const ProbeOptions& options);

  /// Add a row.
  /// \param step greater than last_step()
  /// \throws Error (computation_failed) where the disk is full
  void record(std::int64_t step, double time, std::span<const DiscMotion> motions,
              std::span<const DiscMotion> velocities, const EnergyLedger& ledger);
  /// Hand all rows to the operating system.
  void flush() { table_.flush(); }
  /// Return once all rows are on the disk, as they must be before a checkpoint counts on them.
  void sync() { table_.sync(); }

  /// Of the last row; -1: none.
  [[nodiscard]] std::int64_t last_step() const { return table_.last_step(); }

 private:
  std::vector<Probe> probes_;
  bool energy_;
  GrowingCsv table_;
};

}  // namespace equidem
