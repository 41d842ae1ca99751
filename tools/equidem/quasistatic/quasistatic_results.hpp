// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of `equidem quasistatic`.
#pragma once

#include "equidem/breakage/breakage_run.hpp"
#include "equidem/contact/effects.hpp"

#include "problem.hpp"

namespace equidem {

/// Strengths, path and control.
Results path_results(const BreakageScene& scene, std::size_t cut);

/// Events, avalanches, energies, stability, residual.
Results quasistatic_results(const Problem& problem, const Effects& effects, const BreakageScene& scene, std::size_t cut,
                            const BreakageRun& run, const BreakableSystem& system);

}  // namespace equidem
