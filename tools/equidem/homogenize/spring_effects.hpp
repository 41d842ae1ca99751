// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// `equidem homogenize --sensitivities` reports what springs do to the moduli in report, JSON, table, pictures and
/// arrays.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "equidem/homogenize/sensitivities.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/results.hpp"

#include "command.hpp"
#include "problem.hpp"

namespace equidem {

inline constexpr const char* sensitivities_name = "sensitivities.csv";

/// Returns the part of the report and of the JSON.
Results spring_effects(const Problem& problem, const Matrix3& stiffness, const SpringSensitivities& found);

/// One row per contact: contact, i, j, kN_Pa, kT_Pa, [kM_N,] and of each spring the derivatives of K, G, E and nu
/// (plane stress).
Table sensitivity_table(const Problem& problem, const Matrix3& stiffness, const SpringSensitivities& found);

/// Pictures of what the springs of each contact do to E, G and nu (plane stress), where [output] asks for some.
std::vector<std::string> sensitivity_pictures(const OutputCase& wanted);
void draw_sensitivities(const CommonOptions& options, const Problem& problem, const Matrix3& stiffness,
                        const SpringSensitivities& found);

/// dC_dkN, dC_dkT and, where contacts bend, dC_dkM, in 1/m²: (contacts, 3, 3).
std::vector<ResultArray> sensitivity_arrays(const std::shared_ptr<const SpringSensitivities>& found);
/// dC_dx, dC_dy and, where contact points follow the radii, dC_dradius: (discs, 3, 3) in Pa/m.
std::vector<ResultArray> shape_arrays(const ShapeSensitivities& found);

}  // namespace equidem
