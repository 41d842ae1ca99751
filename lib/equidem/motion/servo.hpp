// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Servo control: a wall moves so that it pushes the bodies with a wanted force.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "equidem/core/vector.hpp"
#include "equidem/motion/schedule.hpp"

namespace equidem {

/// Control of a wall by the force F with which it pushes bodies along `direction`. In each step its speed is
/// v' = (relaxation (W - F) + k dt u + c v)/(k dt + c), at most max_speed either way; W is the wanted force, v the
/// speed of the last step, u its mean over the last 25/relaxation steps or so, in which the force was near W and the
/// wall slower than its limits, k and c are the sums of stiffness and dashpot of the contacts on the wall along the
/// direction. If the bodies moved at u, F' = F + k dt (v' - u) + c (v' - v) would mend that share of the difference.
/// Without dashpots and u this is the gain of Itasca's PFC, v' = alpha (W - F)/(k dt). A wall that touches nothing
/// approaches at max_speed. Until W is reached, it comes in at (W - F)/(2 Z) at most, Z the sum of sqrt(k m).
struct Servo {
  Vec2 direction = {};                      ///< unit, towards the bodies
  Schedule wanted = {};                     ///< force, N (discs: N/m), or stress, Pa; >= 0
  bool is_stress = false;                   ///< the wanted force is the stress times the length
  double length = 0;                        ///< of a stress: m; 0: the present length between two walls
  std::array<std::string, 2> between = {};  ///< names of those walls
  /// m/s, > 0. Empty: that at which one of the bodies, at rest, pushes the wall by 5 % of the larger of W and F.
  std::optional<double> max_speed = {};
  double relaxation = 0.5;  ///< in (0, 1]
  /// Name of a wall that moves by the same way against it; both then follow the mean of their forces. Empty: none.
  std::string mirror = {};
  bool goes_on = false;    ///< in a stage: the servo of the stage before, in the middle of its schedule
  std::string place = {};  ///< in the user's input, for messages; empty: not known
};

/// How well a servo wall has kept what was wanted.
struct ServoReport {
  std::string wall, mirror;  ///< names; the second may be empty
  bool touched = false;      ///< the wall has met a body
  bool reached = false;      ///< the force has come within 1 % of the wanted one; before, the last three mean nothing
  double wanted = 0;         ///< force in the last step, N (discs: N/m)
  double force = 0;          ///< likewise
  double max_speed = 0;      ///< limit of its speed then, given or chosen, m/s
  double overshoot =
      0;            ///< largest F - W since then, F the mean over 1/sqrt(k/m), over the largest W so far; NaN: W was 0
  double peak = 0;  ///< the same of F in single steps, in which discs knock
  double mean_error = 0;  ///< mean |F - W| since then, over the same
};

/// \param name of the wall, for messages
/// \throws Error (bad_input): a direction that is not a unit vector, a wanted force that is or becomes negative, a
///         speed or a relaxation out of range
void check(const Servo& servo, const std::string& name);

}  // namespace equidem
