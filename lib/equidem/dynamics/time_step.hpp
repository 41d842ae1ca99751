// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How long a step of a run may be, and how long it is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// Where the step of a run comes from.
enum class TimeStepRule {
  lanczos,  ///< a fraction of the exact critical step
  bound,    ///< a fraction of a guaranteed step: no contact taken alone with its share of inertia is faster
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
  std::optional<double> step = {};  ///< s, given: the rule is not asked
  /// s, of the run: where it would be over before the exact critical step is found, the bound is taken for it. 0: not
  /// known.
  double duration = 0;
  bool allow_unstable = false;  ///< let a step past the limit pass, and kT < 0
};

struct TimeStep {
  double step = 0;                 ///< s
  double critical = 0;             ///< s: any step below is stable; infinite where nothing vibrates
  bool exact = false;              ///< critical is the limit itself, not a bound below it
  double omega_max = 0;            ///< rad/s: highest natural frequency, or the bound above it
  double growth_rate = 0;          ///< 1/s: > 0 where motions grow whatever the step, at least so fast
  std::string rule;                ///< "lanczos", "bound", "thesis", "given"
  std::vector<std::string> notes;  ///< sentences: how it was decided, and what it does not cover

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
/// keeps the step of leapfrog and of the fourth-order scheme below
/// 2/alpha, past which it turns velocities around. The other integrators have the limits of
/// integrator.hpp for the highest mode.
/// \throws Error (bad_input) on options or magnitudes out of range, a step past the limit, motions that grow whatever
///         the step, a scheme
///         that no step makes stable
TimeStep choose_time_step(const Scene& scene, const SimulationOptions& options, const TimeStepOptions& wanted = {});

}  // namespace equidem
