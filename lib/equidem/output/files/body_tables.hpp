// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// An assembly with its results, and bodies, their contacts and bonds as CSV.
#pragma once

#include <cassert>
#include <filesystem>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/turns.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// A view: the data must outlive it. An empty span means "not computed": its columns, arrays and colours are omitted.
struct AssemblyState {
  const Assembly& assembly;
  std::span<const DiscMotion> motions = {};           ///< per disc
  std::span<const ContactForce> contact_forces = {};  ///< per contact
  std::span<const Tensor2> stresses = {};             ///< per disc, Pa
  std::span<const double> bending_moments = {};       ///< per contact, N, on its first disc
};

/// Precondition: sizes agree.
inline void assert_consistent([[maybe_unused]] const AssemblyState& state) {
  assert(state.motions.empty() || state.motions.size() == state.assembly.size());
  assert(state.contact_forces.empty() || state.contact_forces.size() == state.assembly.contacts.size());
  assert(state.bending_moments.empty() || state.bending_moments.size() == state.assembly.contacts.size());
  assert(state.stresses.empty() || state.stresses.size() == state.assembly.size());
}

/// Half the trace of a plane stress tensor, Pa; tension positive.
constexpr double mean_stress(const Tensor2& stress) {
  return 0.5 * (stress.xx + stress.yy);
}

/// Rotation of a vector from the frame of a body.
/// \param angle of the body, rad
inline Vec2 turned(Vec2 vector, double angle) {
  const double turns = angle / (2 * std::numbers::pi);
  return sine_of_turns(turns + 0.25) * vector + sine_of_turns(turns) * perpendicular(vector);
}

/// One row per disc: disc, x_m, y_m, radius_m, [ux_m, uy_m, rotation_rad,] [stress_xx_Pa, stress_yy_Pa, stress_xy_Pa,
/// stress_yx_Pa,] [cell_area_m2]; columns in brackets where known.
/// \throws Error (bad_input) as write_file does
void write_disc_csv(const std::filesystem::path& path, const AssemblyState& state, bool overwrite);

/// One row per contact: i, j, shift_x, shift_y, branch_x_m, branch_y_m, lever_i_m, lever_j_m, [normal_x, normal_y,
/// offset_i_m, offset_j_m,] [normal_force_N_per_m (tension positive), tangential_force_N_per_m, force_x_N_per_m,
/// force_y_N_per_m (on disc i)].
/// \throws Error (bad_input) as write_file does
void write_contact_csv(const std::filesystem::path& path, const AssemblyState& state, bool overwrite);

/// Colliding bodies with the data of their rows.
struct WrittenGrains {
  std::span<const Grain> grains;
  std::span<const Clump> clumps;
  std::span<const std::string> groups;        ///< of each grain
  std::span<const double> densities;          ///< of each, kg/m³; empty: none is known
  std::optional<Vec2> period = {};            ///< m, of a periodic packing
  std::span<const std::size_t> numbers = {};  ///< of each in its run; empty: as the rows
};

/// One row per grain: grain, [number,] group, x_m, y_m, radius_m, [short_half_axis_m,] vx_m_per_s, vy_m_per_s,
/// spin_rad_per_s, angle_rad, [density_kg_per_m3,] [period_x_m, period_y_m,] [discs_m]. The columns in brackets are
/// there where there are numbers, ellipses (empty of other bodies), densities, a period (the same in all rows) and
/// clumps ("x y r; x y r" in the frame of the body, empty of other bodies). A case file reads it back with [grains]
/// path, to the same bits, but refuses a period. \throws Error (bad_input) as write_file does
void write_grain_csv(const std::filesystem::path& path, const WrittenGrains& rows, bool overwrite);

/// One row per contact of the last step: i, j (empty where it is a wall), wall (its name), overlap_m, closing_m_per_s,
/// normal_x, normal_y (from i), normal_force_N, tangential_force_N (of discs _N_per_m, compression positive),
/// [rolling_moment_N_m (of discs _N), where some contact has one,] mode, steps.
/// \throws Error (bad_input) as write_file does
void write_grain_contact_csv(const std::filesystem::path& path, std::span<const GrainContact> contacts,
                             std::span<const Wall> walls, Body body, bool overwrite);

/// One row per bond: i, j, normal_dashpot, tangential_dashpot, rolling_dashpot, normal_spring, tangential_spring,
/// bending_spring (units: GrainBond), tension and shear (N/m) where `strengths` are given. A case file reads it back
/// with [bonds] path; springs are then unstretched in that file's configuration.
/// \param strengths in the order of the bonds, or none
/// \throws Error (bad_input) as write_file does
void write_bond_csv(const std::filesystem::path& path, std::span<const GrainBond> bonds,
                    const ContactStrengths& strengths, bool overwrite);

}  // namespace equidem
