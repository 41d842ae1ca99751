// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Complex moduli over frequency of `equidem homogenize` with [viscoelastic]: report and JSON, table, plot, arrays.
#pragma once

#include <string>
#include <vector>

#include "equidem/homogenize/viscoelastic_stiffness.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/output/results.hpp"

#include "command.hpp"

namespace equidem {

/// Names of the table and of the plot.
inline constexpr const char* viscoelastic_table_name = "viscoelastic.csv";
inline constexpr const char* moduli_over_frequency = "moduli_over_frequency";

/// The JSON has viscoelastic: {normal, tangential, solver, factor_bytes, harmonic: [{frequency, moduli as {storage,
/// loss}, ...}, ...]}.
Results viscoelastic_results(const Viscoelasticity& springs, const ViscoelasticStiffness& result);
/// One row for each frequency.
Table viscoelastic_table(const ViscoelasticStiffness& result);
/// Storage and loss of K and G over frequency; without those that are 0 at every frequency.
Plot viscoelastic_plot(const std::string& title, const ViscoelasticStiffness& result);
/// viscoelastic/frequencies (n) in Hz; complex bulk_moduli_2d, shear_moduli, young_moduli in plane strain (n) in Pa,
/// poisson_ratios in plane strain (n) and stiffnesses (n, 9) by rows in Pa.
std::vector<ResultArray> viscoelastic_arrays(const ViscoelasticStiffness& result);

}  // namespace equidem
