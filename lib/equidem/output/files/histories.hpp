// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Histories: how chosen discs and the energies change with time, as CSV.
/// The energy ledger as columns of tables and as a JSON object.
/// Loads of bodies on walls, as columns of tables and as results.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/contact/body_contact.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/motion/probe.hpp"
#include "equidem/motion/wall.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

struct ProbeOptions {
  BodyFamily family = BodyFamily::bonded;  ///< family whose ledger terms are written
  Body body = Body::disc;                  ///< unit of energies: J per metre of depth, of spheres J
  double interval = 5;                  ///< s of wall-clock time between two writes; 64 KiB of rows are written at once
  std::vector<std::string> walls = {};  ///< names of all walls that the run has at some time
  bool cell = false;                    ///< the rows have the periodic cell
  bool overwrite = false;               ///< a file of that name
  std::optional<FileMark> continue_from = {};  ///< continue the file of an earlier run behind this mark
};

/// Writes rows: step, time_s; the quantities of every probe: NAME_ux_m, NAME_uy_m; NAME_rotation_rad; NAME_x_m,
/// NAME_y_m; NAME_angle_rad; NAME_vx_m_per_s, NAME_vy_m_per_s; NAME_spin_rad_per_s; NAME_stress_xx_Pa, _xy_, _yx_,
/// _yy_; NAME_inside of a probe with a box; those of every wall (wall_loads.hpp) and of the periodic cell
/// (cell_history.hpp); then the columns of the energy ledger (energies.hpp).
class ProbeWriter {
 public:
  /// \param bodies of the scene
  /// \throws Error (bad_input) where two probes share a name or one has no body or one that is not there, or a stress
  ///         without a box, where a
  ///         probe and a wall have a column of one name, where the file exists and neither `overwrite` nor
  ///         `continue_from` is set, where it cannot be written, or as GrowingCsv where it cannot be continued
  ProbeWriter(std::filesystem::path path, std::vector<Probe> probes, std::size_t bodies, const ProbeOptions& options);

  /// Add a row.
  /// \param step greater than last_step()
  /// \param motions displacements and rotations, or positions and angles, of all bodies
  /// \param regular as in GrowingCsv::add
  /// \param cell given where ProbeOptions::cell is set
  /// \param contacts of the bodies, where a probe has a stress
  /// \throws Error (computation_failed) where the disk is full
  void record(std::int64_t step, double time, std::span<const DiscMotion> motions,
              std::span<const DiscMotion> velocities, std::span<const WallState> walls, const EnergyLedger& ledger,
              bool regular = true, const std::optional<CellState>& cell = {},
              std::span<const BodyContact> contacts = {});
  /// Write all rows to the operating system.
  void flush() { table_.flush(); }
  /// Sync all rows to disk, as required before a checkpoint refers to them.
  void sync() { table_.sync(); }
  [[nodiscard]] FileMark mark() const { return table_.mark(); }

  /// Step of the last row; -1: none.
  [[nodiscard]] std::int64_t last_step() const { return table_.last_step(); }

 private:
  std::vector<Probe> probes_;
  BodyFamily family_;
  std::vector<std::string> walls_;
  bool cell_;
  GrowingCsv table_;
};

/// "" for spheres, "_per_m" for discs: the end of the names of columns with masses, forces and energies.
constexpr const char* per_depth(Body body) {
  return body == Body::disc ? "_per_m" : "";
}

/// "kinetic_J", ..., "error_J"; of discs "kinetic_J_per_m".
std::vector<std::string> energy_columns(BodyFamily family, Body body);
std::vector<double> energy_cells(BodyFamily family, const EnergyLedger& ledger);

/// One row per moment: step, time_s, energy_columns.
/// \throws Error (bad_input) as write_file does
void write_energy_csv(const std::filesystem::path& path, std::span<const EnergySample> energies, BodyFamily family,
                      Body body, bool overwrite);

/// Every term of the ledger, then elastic, dissipated, input, error, and relative_error, the error over `scale`.
Results energy_results(BodyFamily family, Body body, const EnergyLedger& ledger, double scale);

/// For each wall wall_NAME_x_m, wall_NAME_y_m, wall_NAME_vx_m_per_s, wall_NAME_vy_m_per_s, wall_NAME_force_x_N,
/// wall_NAME_force_y_N, wall_NAME_moment_N_m; of colliding bodies also wall_NAME_impulse_x_N_s,
/// wall_NAME_impulse_y_N_s, wall_NAME_work_J. Of discs the names of the latter six end with _per_m.
std::vector<std::string> wall_columns(std::span<const std::string> names, BodyFamily family, Body body);
/// In the order of wall_columns; NaN for a wall that is not there.
std::vector<double> wall_cells(std::span<const std::string> names, BodyFamily family, std::span<const WallState> walls);

/// forces_on_walls: a list with name, place, force, moment, of colliding bodies also impulse and work.
Results wall_results(std::span<const WallState> walls, BodyFamily family, Body body);

}  // namespace equidem
