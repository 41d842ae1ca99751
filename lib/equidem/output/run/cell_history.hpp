// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A periodic cell as columns of tables and as results.
#pragma once

#include <string>
#include <vector>

#include "equidem/motion/any_simulation.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

/// cell_width_m, cell_height_m, cell_shift_m, cell_area_m2, cell_strain_xx, _yy, _xy, cell_stress_xx_Pa, _xy_, _yx_,
/// _yy_, cell_void_ratio, cell_coordination_number.
std::vector<std::string> cell_columns();
/// In the order of cell_columns.
std::vector<double> cell_cells(const CellState& cell);

/// cell: the same quantities.
Results cell_results(const CellState& cell);

}  // namespace equidem
