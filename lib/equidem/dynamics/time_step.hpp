// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Critical time step and choice of the time step of a run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// Rule for the time step of a run.
enum class TimeStepRule {
  lanczos,  ///< a fraction of the exact critical step
  bound,    ///< a fraction of a guaranteed step, from the highest frequency of any single contact with its share of
            ///< inertia
  thesis,   ///< an eighth of the period of one disc on one normal spring, 2 pi min sqrt(m/kN)/8 (Sukegawa 2010): no
            ///< guarantee
};

template <>
struct EnumNames<TimeStepRule> {
  static constexpr const char* what = "rule for the time step";
  static constexpr NamedValue<TimeStepRule> list[] = {
      {TimeStepRule::lanczos, "lanczos"}, {TimeStepRule::bound, "bound"}, {TimeStepRule::thesis, "thesis"}};
};

struct TimeStepOptions {
  TimeStepRule rule = TimeStepRule::lanczos;
  double fraction = 0.8;            ///< of the critical step or of the bound, in (0, 1]
  std::optional<double> step = {};  ///< given step, s: the rule is not used
  bool step_of_rule = false;  ///< the given step is one of the rule, of a run that goes on: so is the critical step
  /// Duration of the run, s: if the run takes less time than the exact critical step, the bound is used. 0: not known.
  double duration = 0;
  bool allow_unstable = false;  ///< allow a step above the limit, and kT < 0
};

struct TimeStep {
  double step = 0;                 ///< s
  double critical = 0;             ///< s: any smaller step is stable; infinite if nothing vibrates
  bool exact = false;              ///< critical is the exact limit, not a lower bound
  double omega_max = 0;            ///< rad/s: highest natural frequency, or the bound above it
  double growth_rate = 0;          ///< 1/s: > 0 if motions grow for any step; lower bound of their growth
  std::string rule;                ///< "lanczos", "bound", "thesis", "given"
  std::vector<std::string> notes;  ///< sentences: how the step was chosen, and its limitations

  [[nodiscard]] double ratio() const { return step / critical; }
  /// Step, critical step, their ratio, and the notes.
  [[nodiscard]] std::string report() const;
};

/// Choose or check the step of a run; options.time_step is not read.
///
/// A step h of leapfrog is stable where 4 M - 2 h C - h² K is positive definite (K over the components that supports
/// leave free, C of the dashpots at contacts, which act half a step late; mass-proportional damping does not enter).
/// The critical step is thus that of the springs k + 2 c/h, and is found from its own eigenvector in a few rounds. For
/// stiffness-proportional damping it is omega h = 2 (sqrt(1 + zeta²) - zeta), zeta = beta omega/2 of the highest mode.
/// Local damping by the share alpha lowers the limit to omega h = 2/sqrt(1 + alpha). Mass-proportional damping by alpha
/// limits the step of leapfrog and of the fourth-order scheme to 2/alpha, above which it reverses velocities. The other
/// integrators have the limits of integrators.hpp for the highest mode.
/// \throws Error (bad_input) on options or magnitudes out of range, a step above the limit, motions that grow for any
///         step, a scheme that is unstable for any step
TimeStep choose_time_step(const Scene& scene, const SimulationOptions& options, const TimeStepOptions& wanted = {});

}  // namespace equidem
