// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Shaking of a box: all its walls move by one displacement, whose second derivative is a cos(2 pi f (t - start)).
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "equidem/motion/wall.hpp"

namespace equidem {

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
