// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Coarse fields as a table, for ParaView, and as pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "equidem/fields/box_measures.hpp"

namespace equidem {

/// Write NAME.csv, one row per cell: x_m, y_m (its middle), stress_xx_Pa, stress_yy_Pa, stress_xy_Pa, stress_yx_Pa,
/// pressure_Pa (minus the mean of xx and yy), solid_fraction, coordination, vx_m_per_s, vy_m_per_s; NAME.vti, the same
/// as cell data of a VTK image; NAME.png, four maps of pressure, solid fraction, coordination and speed. Of fields
/// without cells the table alone, without rows.
/// \return the paths
/// \throws Error (bad_input) as write_file does
std::vector<std::filesystem::path> write_fields(const std::filesystem::path& folder, const std::string& name,
                                                const CoarseFields& fields, bool overwrite);

}  // namespace equidem
