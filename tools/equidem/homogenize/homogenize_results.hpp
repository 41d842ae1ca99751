// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Complex moduli over frequency of `equidem homogenize` with [viscoelastic]: report and JSON, table, plot, arrays.
/// Report and JSON of `equidem homogenize`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "equidem/contact/material_springs.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/viscoelastic_stiffness.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/output/results.hpp"

#include "command.hpp"
#include "problem.hpp"

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

/// Moduli by Abe (1996) for the springs of the case.
struct RelationBeside {
  std::string name;  ///< "mean field, eqs. (21), (22)"
  double bulk_modulus_2d = 0;
  double shear_modulus = 0;
};

/// "solved"; "unstable" where the network would give way; "unjudged" where the solver cannot tell.
const char* status_of(const EffectiveStiffness& result);

/// Report and JSON of the verb.
Results homogenized_results(const Problem& problem, const BoundedStiffness& homogenized,
                            const std::optional<RelationBeside>& relation);
/// Adds the results to those of a problem. \param of_problem results that come first \param fabric none: not known
Results homogenized_results(const Problem& problem, Results of_problem, bool periodic,
                            const BoundedStiffness& homogenized, const std::optional<Fabric>& fabric,
                            const std::optional<RelationBeside>& relation);
/// Moduli by the relation of Abe (1996), where the springs stand for an isotropic continuum.
std::optional<RelationBeside> relation_beside(const SpringConstants& springs, const ChosenRelation& chosen);

}  // namespace equidem
