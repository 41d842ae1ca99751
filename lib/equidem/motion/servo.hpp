// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Servo control: a wall moves, or a periodic cell is stretched, so that a wanted force or stress acts.
#pragma once

#include <array>
#include <cstdint>
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

/// How well a force or a stress has kept what was wanted.
struct ControlReport {
  bool reached = false;  ///< it has come within 1 % of that; before, the last three mean nothing
  double wanted = 0;     ///< in the last step, N (discs: N/m) or Pa
  double present = 0;    ///< likewise
  /// Largest excess over the largest wanted so far: in the mean of some steps, and in a single one. NaN: 0 was wanted.
  double overshoot = 0, peak = 0;
  double mean_error = 0;  ///< mean absolute difference since it was reached, over the same
};

struct ServoReport : ControlReport {
  std::string wall = {}, mirror = {};  ///< names; the second may be empty
  bool touched = false;                ///< the wall has met a body
  double max_speed = 0;                ///< limit of its speed in the last step, given or chosen, m/s
};

struct CellServoReport : ControlReport {
  std::string component;  ///< "xx" or "yy"
};

/// What the control of a force F or a stress goes on from at the start of a step: W is wanted.
struct ControlState {
  double wanted = 0, present = 0;  ///< W and F of the last step
  double rate = 0;                 ///< in the present step: speed of a wall, m/s, or stretch of a cell, 1/s
  double mean_rate = 0;            ///< of the last steps
  double largest_wanted = 0;       ///< largest |W|
  double excess = 0;               ///< mean of F - W over some steps, over largest_wanted
  double overshoot = 0, peak = 0;  ///< largest excess, largest F - W of a step over largest_wanted
  double errors = 0;               ///< sum of |F - W| over largest_wanted
  std::int64_t steps = 0;          ///< number of those
  bool reached = false;            ///< F has come within 1 % of W, or has passed it
  bool arrived = false;            ///< likewise, in this stage or before
  int side = 0;                    ///< 1, -1: F began above or below W; 0: not known yet

  /// The rate v' = (relaxation (W - F) + k dt u + c v)/(k dt + c) (Servo).
  /// \param spring, dashpot k dt and c: change of F by a step at the rate 1, and by a change of the rate by 1
  [[nodiscard]] double asked_rate(double relaxation, double spring, double dashpot) const;
  /// Count the difference of a step.
  /// \param acts whether a body carries the force
  /// \param share that a step adds to the mean in `excess`
  void count(bool acts, double share);
  /// Errors count from here on.
  void count_anew();
  [[nodiscard]] ControlReport report() const;
};

constexpr auto control_numbers = [](auto& c, const auto& visit) {
  visit(c.wanted), visit(c.present), visit(c.rate), visit(c.mean_rate), visit(c.largest_wanted), visit(c.excess);
  visit(c.overshoot), visit(c.peak), visit(c.errors), visit(c.steps), visit(c.reached), visit(c.arrived), visit(c.side);
};

/// \param name of the wall, for messages
/// \throws Error (bad_input): a direction that is not a unit vector, a wanted force that is or becomes negative, a
///         speed or a relaxation out of range
void check(const Servo& servo, const std::string& name);

}  // namespace equidem
