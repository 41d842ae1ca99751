// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The scenes that are stepped: an assembly set in smooth motion.
#pragma once

#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem::bench {

/// kN, kT of every spring, mass of every disc (that of radius 1), and step; about a third of the critical step.
inline constexpr SpringConstants scene_springs = {.kN = 1.0, .kT = 0.5};
inline constexpr Inertia scene_inertia = {.mass = 1.0, .moment = 0.5};
inline constexpr double time_step = 0.2;

/// A wave as long as the assembly, of one hundredth of a radius.
std::vector<DiscMotion> start_motions(const Assembly& assembly);

/// Options beyond springs, for the table of the cost of effects.
struct Variant {
  std::string name;
  SimulationOptions options = {.time_step = time_step};
  SpringConstants springs = scene_springs;
  Vec2 gravity = {};          ///< m/s²
  bool own_springs = false;   ///< a pair for every contact
  bool own_masses = false;    ///< for every disc
  bool driven_sides = false;  ///< left side held, right side pulled
};
/// "springs, rotation", "normal springs only", "rotation restrained", and one effect each.
const std::vector<Variant>& variants();

/// A simulation of a variant with the springs that it refers to.
class Scenery {
 public:
  Scenery(const Assembly& assembly, const Variant& variant);
  [[nodiscard]] Simulation& simulation() { return simulation_; }

 private:
  ContactSprings springs_;
  Simulation simulation_;
};

}  // namespace equidem::bench
