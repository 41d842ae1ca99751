// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The analysis of `equidem stability`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/stopwatch.hpp"
#include "equidem/output/results.hpp"
#include "equidem/statics/critical_ratio.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/waves/vibration.hpp"
#include "equidem/waves/wave_survey.hpp"

#include "command.hpp"
#include "problem.hpp"

namespace equidem {

/// The critical ratio and which motion loses its stiffness there.
struct CriticalMotion {
  bool sought = true;                      ///< false: contacts lie off the lines of centres
  double ratio = 0;                        ///< negative infinity: none down to kT = -kN
  std::optional<ZonePoint> wave = {};      ///< of a periodic assembly
  std::vector<ZonePoint> equivalent = {};  ///< all points of symmetry that reach it
  std::string motion = {};                 ///< in words; empty where it is a wave
  std::string searched = {};               ///< among which motions, for people
};

struct Stability {
  Stability(const Problem& given, Effects active) : problem(given), effects(std::move(active)) {}

  const Problem& problem;
  Effects effects;
  double density = 1;  ///< kg/m³
  bool density_assumed = false;
  std::optional<double> ratio;  ///< kT/kN of the case, where all contacts have the same
  MechanismReport mechanisms;
  InertiaReport inertia;
  CriticalMotion critical;

  ExtremeEigenvalue highest;  ///< omega², (rad/s)², of the assembly as it is given; 0: nothing in it vibrates
  std::optional<ExtremeEigenvalue> lowest;  ///< likewise, where some kT < 0
  double element_bound = 0;                 ///< (rad/s)²
  TimeStepRules rules;

  std::int64_t cell_discs = 0;       ///< number of discs in the smallest cell of a periodic assembly
  std::optional<WaveSurvey> survey;  ///< of a periodic assembly with a small enough cell
  std::vector<PlaneWaves> sound;     ///< of the homogenized continuum, for the directions of the survey, or for two
  double mass_per_area = 0;          ///< kg/m²
  std::string no_continuum;          ///< why there is no homogenized stiffness
  StageTimes times;

  /// "stable", "unstable", or "mechanism".
  [[nodiscard]] std::string status() const;
  /// 1/s, of the fastest wave where surveyed, else of the assembly; 0: nothing grows.
  [[nodiscard]] double growth_rate() const;
};

/// The case with its supports, those of [test] among them; nothing needs to act.
Problem stability_problem(Case resolved);

/// \throws Error (bad_input) where no contact joins any disc, and as check_magnitudes
Stability analyze_stability(const Problem& problem);

/// kg/m³ of the case, or 1.
double density_of(const Case& resolved);

/// omega of omega², or the growth rate with a minus sign: spectra with unstable branches are drawn so.
double signed_root(double squared);

/// Report and JSON of the verb.
Results stability_results(const Stability& stability);

/// \name Tables and plots of the survey. \{
void write_survey(const std::filesystem::path& folder, const Stability& stability, bool overwrite);
/// \throws Error (bad_input) where a file of write_survey could not be written
void expect_survey(const OutputPlan& plan);
/// \}

}  // namespace equidem
