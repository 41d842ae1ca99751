// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Walls: lines and segments, at rest or moving; their nearest point, and crossing.
///
/// Servo control: a wall moves, or a periodic cell is stretched, so that a wanted force or stress acts.
///
/// Shaking of a box: all its walls move by one displacement, whose second derivative is a cos(2 pi f (t - start)).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"
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

/// A wall of infinite mass. Bodies are outside a line on the side of its normal; segments are thin, with two
/// sides and two ends. The normal of a segment points to the left of the direction from `point` to `end`; a centre
/// exactly on a wall counts as on that side.
///
/// Bonded discs take lines with a spring kN, without friction. Colliding bodies take both shapes; stiffness,
/// restitution and friction follow from `kind`.
struct Wall {
  enum class Shape { line, segment } shape = Shape::line;
  std::string name;
  Vec2 point;                         ///< line: a point on it; segment: first end. m
  Vec2 normal = {0, 1};               ///< line: unit, towards the bodies
  Vec2 end = {};                      ///< segment: second end, m
  Schedule move_x = {}, move_y = {};  ///< displacement over time, m; constant 0: at rest
  int kind = 0;                       ///< colliding bodies: row of the table of pairs
  double kN = 0;                      ///< bonded discs: force per m of overlap, Pa, > 0
  std::optional<Servo> servo = {};    ///< motion that is added to the displacement; colliding bodies

  /// Whether a schedule moves it.
  [[nodiscard]] bool moves() const { return move_x.changes() || move_y.changes(); }
  /// Displacement by its schedules.
  [[nodiscard]] Vec2 displacement(double time) const { return {move_x.at(time), move_y.at(time)}; }
  /// Displacement of a line along its normal, m.
  [[nodiscard]] double displacement_along_normal(double time) const { return dot(normal, displacement(time)); }
};

template <>
struct EnumNames<Wall::Shape> {
  using enum Wall::Shape;
  static constexpr const char* what = "shape of a wall";
  static constexpr NamedValue<Wall::Shape> list[] = {{line, "line"}, {segment, "segment"}};
};

/// A wall of a simulation at its time, and what bodies have done to it. N, J, N s: of discs per metre of depth.
struct WallState {
  std::string name = {};
  Vec2 place = {};     ///< of Wall::point, m
  Vec2 velocity = {};  ///< in the step that follows, m/s
  Vec2 force = {};     ///< of the bodies on the wall, mean over the last step, N
  double moment = 0;   ///< of this force about `place`, counter-clockwise, N m
  Vec2 impulse = {};   ///< of this force since the start, N s
  double work = 0;     ///< done on the bodies since the start, J
};

/// Prescribe the displacement of a wall along a direction.
/// \param direction unit
void move_along(Wall& wall, Vec2 direction, const Schedule& displacement);

std::vector<std::string> names_of(std::span<const Wall> walls);

/// \throws Error (bad_input) on numbers that are not finite, a normal that is not a unit vector, a segment of length 0
void check(const Wall& wall);
/// \param name of the wall, for messages
/// \throws Error (bad_input): a direction that is not a unit vector, a wanted force that is or becomes negative, a
///         speed or a relaxation out of range
void check(const Servo& servo, const std::string& name);

/// The point of a wall nearest to a grain.
struct WallContact {
  double distance = 0;  ///< from the wall to the centre; line: signed, negative behind the wall
  Vec2 normal;          ///< unit, from the wall to the centre
  int end = 0;          ///< 1, 2: the point is the first or second end of a segment, or next to it
};

/// nearest() for a segment, without displacement.
WallContact nearest_of_segment(const Wall& wall, const Vec2& centre);

/// Line: the foot of the perpendicular. Segment: the nearest point, ends included. Never NaN for a wall that passes
/// `check`: for a centre on a segment the normal is the wall's own.
/// \param displacement present displacement of the wall, m
inline WallContact nearest(const Wall& wall, const Vec2& displacement, const Vec2& centre) {
  const Vec2 relative = centre - displacement;
  if (wall.shape == Wall::Shape::line) return {dot(wall.normal, relative - wall.point), wall.normal, 0};
  return nearest_of_segment(wall, relative);
}

/// Whether a centre that moves straight from `before` to `after` (both relative to the wall: less its displacement)
/// passes through the wall: changes side on it, ends included. If two successive paths meet on the wall and lead
/// through it, exactly one of them passes.
bool passes_through(const Wall& wall, const Vec2& before, const Vec2& after);

/// Harmonic shaking, a cos(2 pi f (t - start)): the displacement a/(2 pi f)² (1 - cos(...)) begins and ends at rest in
/// the initial position, without drift and without a jump in velocity.
/// \param acceleration a, m/s²
/// \param frequency f, Hz
/// \param start s
/// \param cycles >= 1
/// \throws Error (bad_input) as check(Schedule)
Schedule harmonic_shaking(double acceleration, double frequency, double start, std::int64_t cycles);

struct ShakingOptions {
  Vec2 direction = {1, 0};                  ///< of any length > 0
  double acceleration = 0;                  ///< amplitude a, m/s²
  double frequency = 0;                     ///< f, Hz
  double start = 0;                         ///< s
  std::optional<std::int64_t> cycles = {};  ///< >= 1
  std::optional<double> duration = {};      ///< s, whole cycles, instead of cycles; neither: to the end of the run
};

/// The shaking of a box.
struct Shaking {
  Vec2 direction;                ///< unit
  Schedule displacement;         ///< along it, m
  double peak_acceleration = 0;  ///< m/s²
  double peak_velocity = 0;      ///< m/s
  double peak_displacement = 0;  ///< m
  double frequency = 0;          ///< Hz
  std::int64_t cycles = 0;
};

/// \param run_duration s
/// \throws Error (bad_input), its place the name of the option, or empty: a direction of length 0, a start after the
///         end of the run, cycles and a duration both, a duration of no whole cycles, more than 1e12 cycles, a motion
///         as fast as light, and as harmonic_shaking
Shaking shaking_of(const ShakingOptions& options, double run_duration);

/// Let walls move along a direction.
/// \param direction unit
/// \throws Error (bad_input) if a wall already has a prescribed motion
void shake(std::span<Wall> walls, Vec2 direction, const Schedule& displacement);

}  // namespace equidem
