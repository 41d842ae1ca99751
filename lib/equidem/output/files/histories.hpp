// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Histories: how chosen discs, the energies, walls and a periodic cell change with time, as columns of tables and as
/// results.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/contact/frame.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/motion/saved_state.hpp"
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
/// _yy_; NAME_inside of a probe with a box; of every wall wall_NAME_x_m, _y_m, _vx_m_per_s, _vy_m_per_s,
/// _force_x_N, _force_y_N, _moment_N_m, of colliding bodies also _impulse_x_N_s, _impulse_y_N_s, _work_J, NaN where it
/// is not there (of discs forces, moments, impulses and works per metre of depth: _per_m); of the periodic cell
/// cell_width_m, cell_height_m, cell_shift_m, cell_area_m2, cell_strain_xx, _yy, _xy, cell_stress_xx_Pa, _xy_, _yx_,
/// _yy_, cell_void_ratio, cell_coordination_number; then energy_columns.
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

/// forces_on_walls: a list with name, place, force, moment, of colliding bodies also impulse and work.
Results wall_results(std::span<const WallState> walls, BodyFamily family, Body body);

/// cell: width, height, shift, area, strain, stress, void ratio and coordination number of a periodic cell.
Results cell_results(const CellState& cell);

}  // namespace equidem
