// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Shaking of a box: all its walls move by one displacement, whose second derivative is the prescribed acceleration.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/grains/scene/wall_shape.hpp"

namespace equidem {

constexpr double gal = 0.01;                  ///< m/s²
constexpr double standard_gravity = 9.80665;  ///< m/s², the acceleration g

/// Harmonic shaking, a cos(2 pi f (t - start)): the displacement a/(2 pi f)² (1 - cos(...)) begins and ends at rest in
/// the initial position, without drift and without a jump in velocity. \param acceleration a, m/s²
/// \param frequency f, Hz
/// \param start s
/// \param cycles >= 1
/// \throws Error (bad_input) as check(Schedule)
Schedule harmonic_shaking(double acceleration, double frequency, double start, std::int64_t cycles);

/// Baseline correction of a recorded acceleration, whose integral ends neither at rest nor in the initial position.
enum class Baseline {
  velocity,  ///< subtract a constant: the box ends at rest, displaced
  rest,      ///< subtract a linear function of time: the box ends at rest in the initial position
};

template <>
struct EnumNames<Baseline> {
  using enum Baseline;
  static constexpr const char* what = "baseline";
  static constexpr NamedValue<Baseline> list[] = {{rest, "rest"}, {velocity, "velocity"}};
};

/// A recorded motion as a displacement, and its extremes after the correction.
struct GroundMotion {
  Schedule displacement;         ///< m; 0 before, constant after
  double peak_acceleration = 0;  ///< m/s²
  double peak_velocity = 0;      ///< m/s
  double peak_displacement = 0;  ///< m, at the points of the record
  double final_displacement = 0;
  double correction = 0;  ///< largest baseline correction, m/s²
};

/// The acceleration is linear between its points and integrated twice exactly; velocity and displacement begin at 0.
/// \param times s, ascending, at least two; the first is put at `start`
/// \param accelerations m/s²
/// \throws Error (bad_input) as check(Schedule), on fewer than two points
GroundMotion integrate_motion(std::span<const double> times, std::span<const double> accelerations, double start,
                              Baseline baseline);

/// A recorded displacement: the cubic spline through its points, at rest at both ends (its acceleration is linear
/// between them). The first point is the initial position of the box. \param displacements m
/// \throws Error (bad_input) as integrate_motion
GroundMotion follow_motion(std::span<const double> times, std::span<const double> displacements, double start);

/// A motion a cos(2 pi f (t - start)) of the box, as harmonic_shaking.
struct HarmonicShaking {
  double acceleration = 0;                  ///< amplitude a, m/s²
  double frequency = 0;                     ///< f, Hz
  double start = 0;                         ///< s
  std::optional<std::int64_t> cycles = {};  ///< >= 1
  std::optional<double> duration = {};      ///< s, whole cycles, instead of cycles; neither: to the end of the run
};

/// A recorded motion of the box, as integrate_motion or follow_motion.
struct RecordedShaking {
  enum class Quantity { acceleration, displacement } quantity = Quantity::acceleration;
  std::vector<double> times;           ///< s
  std::vector<double> values;          ///< m/s² or m
  double scale = 1;                    ///< factor of the values
  double start = 0;                    ///< s, of the first point
  Baseline baseline = Baseline::rest;  ///< accelerations only
};

template <>
struct EnumNames<RecordedShaking::Quantity> {
  using enum RecordedShaking::Quantity;
  static constexpr const char* what = "quantity of a record";
  static constexpr NamedValue<RecordedShaking::Quantity> list[] = {{acceleration, "acceleration"},
                                                                   {displacement, "displacement"}};
};

struct ShakingOptions {
  Vec2 direction = {1, 0};  ///< of any length > 0
  std::variant<HarmonicShaking, RecordedShaking> motion = {};
};

/// The shaking of a box.
struct Shaking {
  Vec2 direction;       ///< unit
  GroundMotion motion;  ///< along it
  bool recorded = false;
  double frequency = 0;     ///< Hz, not recorded
  std::int64_t cycles = 0;  ///< not recorded

  [[nodiscard]] double start() const;  ///< s
  [[nodiscard]] double end() const;    ///< s
};

/// \param run_duration s
/// \throws Error (bad_input), its place the name of the option, or empty: a direction of length 0, a start after the
///         end of the run, cycles and a duration both, a duration of no whole cycles, more than 1e12 cycles, a motion
///         as fast as light, and as harmonic_shaking, integrate_motion, follow_motion
Shaking shaking_of(const ShakingOptions& options, double run_duration);

/// Let walls move along a direction.
/// \param direction unit
/// \throws Error (bad_input) if a wall already has a prescribed motion
void shake(std::span<Wall> walls, Vec2 direction, const Schedule& displacement);

}  // namespace equidem
