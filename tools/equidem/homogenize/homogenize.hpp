// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of `equidem homogenize`; with [ensemble] the moduli of many random cells, their scatter, and the
/// size that they need; with --sensitivities what springs do to the moduli.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/sensitivities.hpp"

#include "command.hpp"
#include "problem.hpp"
#include "spring_effects.hpp"

namespace equidem {

/// Moduli by Abe (1996) for the springs of the case.
struct RelationBeside {
  std::string name;  ///< "mean field, eqs. (21), (22)"
  double bulk_modulus_2d = 0;
  double shear_modulus = 0;
};

/// Adds the results to those of a problem. \param of_problem results that come first \param fabric none: not known
Results homogenized_results(const Problem& problem, Results of_problem, bool periodic,
                            const BoundedStiffness& homogenized, const std::optional<Fabric>& fabric,
                            const std::optional<RelationBeside>& relation);
/// Moduli by the relation of Abe (1996), where the springs stand for an isotropic continuum.
std::optional<RelationBeside> relation_beside(const SpringConstants& springs, const ChosenRelation& chosen);

/// Samples the cells of [ensemble] and delivers report, tables, plots and JSON.
/// \param resume keep the samples that lie in --out (option --resume of the verb), compute the others
/// \throws Error (bad_input) where the case has no periodic cell, or the samples in --out are of another case;
///         (computation_failed) where every sample is refused; (interrupted), with what is done kept in --out
void homogenize_ensemble(const CommonOptions& options, const Case& resolved, bool resume = false);

/// Random cells in the number and size that the accuracy requires, regardless of the sizes and numbers in the case; the
/// case that is written names those that were chosen.
/// \throws Error (bad_input) where the case has no periodic cells; (computation_failed) where the accuracy is beyond
///         all means; (interrupted)
void homogenize_to_accuracy(const CommonOptions& options, const Case& resolved, double accuracy);

/// \param failure set where there are none, unless it is
std::optional<SpringSensitivities> sensitivities_of(const Problem& problem, const EffectiveStiffness& result,
                                                    std::optional<Error>& failure);
/// The shift of mean moduli by scatter of the springs. \param failure likewise
std::optional<MeanShift> mean_shift_of(const Problem& problem, const EffectiveStiffness& result,
                                       const SpringSensitivities& sensitivities, int probes,
                                       std::optional<Error>& failure);
/// Over the mean moduli.
Results shift_results(const EffectiveStiffness& result, const MeanShift& found);

/// K, G, E and nu (plane stress) with their derivatives by the springs, and the symbols of those that may be drawn.
std::vector<SpringDependent> moduli_by_springs(const Matrix3& stiffness, const SpringSensitivities& found);
std::vector<std::string> pictures_of_sensitivities();

/// dC_dkN, dC_dkT and, where contacts bend, dC_dkM, in 1/m²: (contacts, 3, 3).
std::vector<ResultArray> sensitivity_arrays(const std::shared_ptr<const SpringSensitivities>& found);
/// dC_dx, dC_dy and, where contact points follow the radii, dC_dradius: (discs, 3, 3) in Pa/m.
std::vector<ResultArray> shape_arrays(const ShapeSensitivities& found);

}  // namespace equidem
