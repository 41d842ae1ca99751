// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A model as discrete-element codes take it: bodies, bonds or contact properties, walls, and what acts.
///
/// Forces, masses and moments of inertia of discs are per metre of depth, those of spheres are whole.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/motion/wall.hpp"
#include "equidem/output/export/engine_features.hpp"

namespace equidem {

struct EngineBody {
  Vec2 position;      ///< m
  double radius = 0;  ///< m
  Inertia inertia;
  Vec2 velocity = {};   ///< m/s
  double spin = 0;      ///< rad/s
  int kind = 0;         ///< of a grain: row of the table of pairs
  DiscForce load = {};  ///< constant, without gravity
  /// Prescribed displacement in x, y (m) and rotation (rad) at the start; none: free.
  std::array<std::optional<double>, 3> held = {};
};

/// A bond of kN and kT, without force at the start.
struct EngineBond {
  std::int32_t i = 0, j = 0;
  double length = 0;  ///< distance of the centres, m
  SpringConstants springs;
  SpringConstants dashpots = {};  ///< N s/m per m; 0: none
  std::int32_t shift_x = 0;       ///< periods from j to its image that i is bonded to
  std::int32_t shift_y = 0;
};

/// A prescribed displacement that changes with time, m or rad.
struct EngineMotion {
  std::size_t component = 0;  ///< 0: x, 1: y, 2: rotation
  Schedule displacement;
  std::vector<std::int32_t> bodies;
};

/// Loads on bodies times a factor that changes with time.
struct EngineLoad {
  Schedule factor;
  std::vector<std::pair<std::int32_t, DiscForce>> shares;
};

struct EngineModel {
  std::string title;
  Body body = Body::disc;
  bool bonded = false;
  bool to_rest = false;        ///< the run ends at rest, not after its duration
  double duration = 0;         ///< s
  double time_step = 0;        ///< s, stable
  double local_damping = 0;    ///< share of the resultant that acts against the velocity (Cundall)
  Vec2 gravity;                ///< m/s²
  std::optional<Vec2> period;  ///< m
  std::vector<EngineBody> bodies;
  std::vector<EngineBond> bonds;
  std::vector<EngineMotion> motions;
  std::vector<EngineLoad> timed_loads;
  /// Radii, m, that place the contact point of bodies at a distance d at (d + r_i - r_j)/2 from i, as the bonds have
  /// it; empty: there are none.
  std::vector<double> lever_radii;
  std::vector<Wall> walls;
  int kinds = 0;                      ///< of grains and walls
  std::vector<PairProperties> pairs;  ///< kinds x kinds, row by row
  bool graded_dashpots = false;       ///< dashpots of bodies of unequal masses, or along the contact
  FoundFeatures found;                ///< that some engine does not carry

  [[nodiscard]] const PairProperties& between(int a, int b) const {
    return pairs[static_cast<std::size_t>(a * kinds + b)];
  }
};

/// Contact points that differ by less, of the length of the bond, count as the same: an engine then computes the model
/// to about that accuracy.
inline constexpr double lever_tolerance = 1e-6;

/// The model of bonded discs; title, to_rest, duration and time_step are not set.
EngineModel engine_model(const Scene& scene, const SimulationOptions& options, Body body);

/// The model of colliding bodies; title, duration and time_step are not set.
EngineModel engine_model(const GrainScene& scene, const GrainOptions& options, Body body);

/// Reduced mass of two bodies, or of a body and a wall.
double reduced_mass(const EngineBody& i, const EngineBody* j);

/// The mass of all bodies, kg, equal to 1e-9; none where they differ.
std::optional<double> common_mass(const EngineModel& model);

/// The mass at a contact across its normal, 1/(1/m_i + 1/m_j + r_i²/I_i + r_j²/I_j), over the reduced mass.
double tangential_mass_share(Body body);

}  // namespace equidem
