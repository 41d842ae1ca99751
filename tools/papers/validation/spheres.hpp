// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Spheres that meet each other or a floor, for the items on impacts.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"

namespace equidem::validation {

/// \param spin rad/s, counter-clockwise
Grain sphere(double radius, double density, Vec2 position, Vec2 velocity, double spin = 0);

/// Spheres of one kind of contact. \param floor with a wall at y = 0
GrainScene spheres(std::vector<Grain> grains, const PairProperties& contact, bool floor);

/// Reduced mass of two bodies, or of a body and a wall.
double reduced_mass(const GrainScene& scene);

/// What became of an impact.
struct Rebound {
  std::vector<Grain> grains;
  double overlap = 0;   ///< largest, m
  double force = 0;     ///< largest normal force, N
  double duration = 0;  ///< s
};
/// An impact of one sphere with the floor, or of two spheres, that begin in touch, until they part.
Rebound collide(const GrainScene& scene, NormalLaw law, double time_step);

/// Grains after a number of steps of the velocity Verlet scheme of LAMMPS.
std::vector<Grain> after_steps(const GrainScene& scene, NormalLaw law, double time_step, std::int64_t steps);

}  // namespace equidem::validation
