// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What bodies do to walls, as columns of tables and as results.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "equidem/material/inertia.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/motion/wall.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

/// For each wall wall_NAME_x_m, wall_NAME_y_m, wall_NAME_vx_m_per_s, wall_NAME_vy_m_per_s, wall_NAME_force_x_N,
/// wall_NAME_force_y_N, wall_NAME_moment_N_m; of colliding bodies also wall_NAME_impulse_x_N_s,
/// wall_NAME_impulse_y_N_s, wall_NAME_work_J. Of discs the names of the latter six end with _per_m.
std::vector<std::string> wall_columns(std::span<const std::string> names, BodyFamily family, Body body);
/// In the order of wall_columns; NaN for a wall that is not there.
std::vector<double> wall_cells(std::span<const std::string> names, BodyFamily family, std::span<const WallState> walls);

/// forces_on_walls: a list with name, place, force, moment, of colliding bodies also impulse and work.
Results wall_results(std::span<const WallState> walls, BodyFamily family, Body body);

}  // namespace equidem
