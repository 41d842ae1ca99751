// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Stability of an assembly: mechanisms, inertia, waves, the critical kT/kN, natural frequencies and time steps.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/statics/adjoint.hpp"
#include "equidem/statics/critical_load.hpp"
#include "equidem/statics/critical_ratio.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/waves/natural_frequencies.hpp"
#include "equidem/waves/vibration.hpp"
#include "equidem/waves/wave_survey.hpp"

namespace equidem {

struct StabilityOptions {
  Rotation rotation = Rotation::from_scene;
  double density = 1;  ///< kg/m³, of the discs; frequencies scale with the inverse of its square root
  Body body = Body::disc;
  SolverOptions solver = {};    ///< of the homogenized continuum and of natural frequencies
  int natural_frequencies = 4;  ///< number of the lowest, >= 0
  bool derivatives = false;     ///< by springs: of natural frequencies, the critical ratio and speeds of sound
};

/// In the order in which they are found; what an assembly does not have is left out.
enum class StabilityStage { inertia, critical_load, time_step, natural_frequencies, waves, continuum, critical_ratio };

template <>
struct EnumNames<StabilityStage> {
  using enum StabilityStage;
  static constexpr const char* what = "stage of stability";
  static constexpr NamedValue<StabilityStage> list[] = {{inertia, "inertia"},
                                                        {critical_load, "critical load"},
                                                        {time_step, "time step"},
                                                        {natural_frequencies, "natural frequencies"},
                                                        {waves, "waves"},
                                                        {continuum, "homogenized continuum"},
                                                        {critical_ratio, "critical kT/kN"}};
};

/// The critical ratio and the motion that loses its stiffness there.
struct CriticalMotion {
  bool sought = true;                      ///< false: see `searched`
  double ratio = 0;                        ///< negative infinity: none down to kT = -kN
  std::optional<ZonePoint> wave = {};      ///< of a periodic assembly
  std::vector<ZonePoint> equivalent = {};  ///< all points of symmetry that reach it
  std::string motion = {};                 ///< in words; empty where it is a wave
  std::string searched = {};               ///< the motions that were searched, in words, or why none were
  /// Per contact, 1/Pa, as of CriticalRatio; of a surveyed cell, whose springs would change in all cells, none.
  std::vector<double> by_kN = {};
};

/// Derivatives of a speed of sound of the homogenized continuum, m/s over the unit of the spring.
struct SoundDerivatives : SpringDerivatives {
  double angle = 0;  ///< rad, of the direction from the x axis
  bool transverse = false;
  double speed = 0;  ///< m/s
};

struct Stability {
  StabilityStage reached = StabilityStage::inertia;  ///< the last that is found; members of later ones are empty
  Effects effects;
  std::optional<double> ratio;  ///< kT/kN, where all contacts have the same (to round-off)
  MechanismReport mechanisms;
  InertiaReport inertia;
  CriticalMotion critical;
  std::optional<CriticalLoad> critical_load;  ///< where forces at rest count

  ExtremeEigenvalue highest;  ///< omega², (rad/s)², of the assembly as it is given; 0: nothing in it vibrates
  std::optional<ExtremeEigenvalue> lowest;  ///< likewise, where some kT < 0
  NaturalFrequencies natural;               ///< of the assembly as it is given, where no kT < 0
  double element_bound = 0;                 ///< (rad/s)²
  TimeStepRules rules;

  std::int64_t cell_discs = 0;       ///< number of discs in the smallest cell of a periodic assembly
  std::optional<WaveSurvey> survey;  ///< of a periodic assembly with a small enough cell
  std::vector<PlaneWaves> sound;     ///< of the homogenized continuum, for the directions of the survey, or for two
  std::vector<SoundDerivatives> sound_derivatives;  ///< along x and y, where both speeds differ and are not 0
  double mass_per_area = 0;                         ///< kg/m²
  std::string no_continuum;                         ///< why there is no homogenized stiffness
  StageTimes times;

  /// "stable", "unstable", or "mechanism".
  [[nodiscard]] std::string status() const;
  /// 1/s, of the fastest wave where surveyed, else of the assembly; 0: nothing grows.
  [[nodiscard]] double growth_rate() const;
};

/// \param supports of a free assembly; without any it is judged as a free body
/// \throws Error (bad_input) where no contact joins any disc or the supports hold every disc, and as check_magnitudes;
///         ErrorWith<Stability> where a stage behind the inertia fails (the highest frequency is not found) or the user
///         asked to stop
Stability analyze_stability(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
                            const StabilityOptions& options = {});

}  // namespace equidem
