// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A box that shakes: its walls move all alike, by a displacement whose second derivative is the acceleration wanted.
#pragma once

#include <cstdint>
#include <span>

#include "equidem/grains/scene/wall_shape.hpp"

namespace equidem {

constexpr double gal = 0.01;                  ///< m/s²
constexpr double standard_gravity = 9.80665;  ///< m/s², the acceleration g

/// Harmonic shaking, a cos(2 pi f (t - start)): the displacement a/(2 pi f)² (1 - cos(...)) begins and ends at rest
/// where the box stands, without drift and without a jump in velocity. \param acceleration a, m/s²
/// \param frequency f, Hz
/// \param start s
/// \param cycles >= 1
/// \throws Error (bad_input) as check(Schedule)
Schedule harmonic_shaking(double acceleration, double frequency, double start, std::int64_t cycles);

/// What is taken from a recorded acceleration, whose integral ends neither at rest nor in place.
enum class Baseline {
  velocity,  ///< a constant: the box ends at rest, somewhere else
  rest,      ///< a straight line in time: it ends at rest where it began
};

/// A recorded motion as a displacement, and its extremes after the correction.
struct GroundMotion {
  Schedule displacement;         ///< m; 0 before, constant after
  double peak_acceleration = 0;  ///< m/s²
  double peak_velocity = 0;      ///< m/s
  double peak_displacement = 0;  ///< m, at the points of the record
  double final_displacement = 0;
  double correction = 0;  ///< m/s²: the most that the baseline took away
};

/// The acceleration is linear between its points and integrated twice exactly; velocity and displacement begin at 0.
/// \param times s, ascending, at least two; the first is put at `start`
/// \param accelerations m/s²
/// \throws Error (bad_input) as check(Schedule), on fewer than two points
GroundMotion integrate_motion(std::span<const double> times, std::span<const double> accelerations, double start,
                              Baseline baseline);

/// A recorded displacement: the cubic spline through its points, at rest at both ends (its acceleration is linear
/// between them). The first point is where the box stands. \param displacements m
/// \throws Error (bad_input) as integrate_motion
GroundMotion follow_motion(std::span<const double> times, std::span<const double> displacements, double start);

/// Let walls move along a direction.
/// \param direction unit
/// \throws Error (bad_input) where a wall moves by itself
void shake(std::span<GrainWall> walls, Vec2 direction, const Schedule& displacement);

}  // namespace equidem
