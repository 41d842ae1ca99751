// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that collide: what is there, what acts, by which law.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "equidem/contact/collision_laws.hpp"
#include "equidem/contact/restitution.hpp"
#include "equidem/contact/sliding.hpp"
#include "equidem/grains/wall_shape.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// A round body. Units are those of its mass: kg and N for spheres, kg and N per metre of depth for discs.
struct Grain {
  Vec2 position;  ///< m
  double radius = 0;
  Inertia inertia;
  Vec2 velocity = {};
  double spin = 0;   ///< rad/s
  double angle = 0;  ///< rad
  int kind = 0;      ///< row of the table of pairs
};

/// How bodies of two kinds meet.
struct PairProperties {
  /// linear laws N/m, hertz_dashpot N/m^(3/2); used where > 0, else `dimensionless`.
  double stiffness = 0;
  /// a = k dt²/m, held whatever the step and the masses (the paper's way); hertz_dashpot: k d_c^(1/2) dt²/m.
  double dimensionless = 0;
  double restitution = 1;
  ContactEnd end = ContactEnd::at_zero_force;  ///< linear_dashpot, hertz_dashpot, exact_flow
  double friction = 0;                         ///< mu
  /// kT/kN >= 0; hertz_dashpot: kT/(k d_c^(1/2)). With friction > 0 and 0 here the contact slides always, Coulomb's law regularized by
  /// the step alone.
  double tangential_ratio = 0;
  double tangential_damping = 0;  ///< zeta_T: dashpot 2 zeta_T sqrt(m kT), m the effective tangential mass
  FrictionCap cap = FrictionCap::whole_force;
  bool operator==(const PairProperties&) const = default;
};

/// What collides.
struct GrainScene {
  std::vector<Grain> grains;
  std::vector<GrainWall> walls;
  Vec2 gravity = {};  ///< m/s²
  int kinds = 1;
  std::vector<PairProperties> pairs;  ///< kinds x kinds, symmetric, row by row

  [[nodiscard]] const PairProperties& between(int a, int b) const {
    return pairs[static_cast<std::size_t>(a * kinds + b)];
  }
};

struct GrainOptions {
  NormalLaw law = NormalLaw::exact_flow;
  /// exact_flow and the maps have their own step; the force laws take either.
  enum class Scheme {
    semi_implicit_euler,  ///< v' = v + a(x, v) dt, x' = x + v' dt; gravity is added after the contact force (the paper's runs)
    velocity_verlet,  ///< half kick, drift, force with the velocities of the half step, half kick (LAMMPS)
  } scheme = Scheme::semi_implicit_euler;
  double time_step = 0;         ///< s, > 0
  double reference_length = 0;  ///< d_c, m; 0: twice the largest radius
  double margin = 0;            ///< of the neighbour lists, m; 0: chosen from speeds and density
  bool refuse_crossing = true;  ///< false: bodies may pass through one another, for studies of laws that let them
};

using PlaceOfGrain = std::function<std::string(std::size_t grain)>;

/// \throws Error (bad_input): no grains, radius or mass not positive, numbers not finite or beyond 1e150, kinds and pairs that do not fit, a table that is
///         not symmetric, neither or both of stiffness and dimensionless, restitution out of range for the law, friction negative,
///         velocity_verlet with a map, the time step not positive, grains that start inside one another (centre within the other) or
///         with the centre behind a line
/// \param where the user wrote a grain, for errors; may be empty
void check(const GrainScene& scene, const GrainOptions& options, const PlaceOfGrain& where = {});

}  // namespace equidem
