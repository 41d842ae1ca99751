// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of `equidem quasistatic`.
#pragma once

#include <optional>

#include "equidem/breakage/event_path.hpp"
#include "equidem/contact/effects.hpp"

#include "problem.hpp"

namespace equidem {

/// Strengths, path and control.
/// \param residual_friction of contacts without a bond, where they are frictional
Results path_results(const BreakageScene& scene, std::size_t cut, std::optional<double> residual_friction);

/// The scene of results.
struct QuasistaticOutcome {
  const Problem& problem;
  const Effects& effects;
  BreakageScene scene;
  std::size_t cut = 0;
  std::optional<double> residual_friction{};  ///< of contacts without a bond, where they are frictional
};

/// Events, avalanches, energies, what comes loose, stability, residual.
Results quasistatic_results(const QuasistaticOutcome& outcome, const EventPath& run);

}  // namespace equidem
