// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What collides in the benchmarks.
#pragma once

#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem::bench {

/// Discs of radius 0.5 m and mass 1 kg in a square box, on a grid with solid fraction `fraction`, with random
/// velocities of 1 m/s.
GrainScene gas(int discs, double fraction, const PairProperties& pair);

/// Discs on a wide grid that fall and drift apart and touch nothing.
GrainScene free_flight(int discs);

/// Rows of discs that rest on a floor between two walls, pressed together by gravity.
GrainScene packed_bed(int columns, int rows, const PairProperties& pair);

}  // namespace equidem::bench
