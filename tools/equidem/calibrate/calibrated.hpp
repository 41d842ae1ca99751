// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case that was calibrated: the numbers of `equidem calibrate`.
#pragma once

#include <optional>
#include <string>

#include "equidem/homogenize/calibrate/calibrate.hpp"

#include "problem.hpp"

namespace equidem {

/// The springs that the mean field of Abe (1996), eqs. (21) and (22), advises, and what the assembly shows with them.
struct MeanFieldGuess {
  SpringConstants springs;                ///< before weighting
  std::optional<EffectiveModuli> moduli;  ///< by one more factorization
  std::string missing;                    ///< why there are no such springs or moduli
};

struct Calibrated {
  const Problem& problem;  ///< its springs are those found
  Calibration found;
  std::optional<MeanFieldGuess> mean_field;  ///< of assemblies that are no lattice
  StageTimes times;

  [[nodiscard]] const ElasticModuli& wanted() const { return problem.resolved.material->moduli; }
};

/// Report and JSON of the verb.
Results calibrated_results(const Calibrated& calibrated, const Effects& effects);

}  // namespace equidem
