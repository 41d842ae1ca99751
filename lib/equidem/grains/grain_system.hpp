// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What the steps of colliding bodies work on: bodies and walls in the order of their places, candidates for contact.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/contact/exact_contact.hpp"
#include "equidem/grains/contacts/bond_step.hpp"
#include "equidem/grains/contacts/touch_instants.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/kernels/bond_loop.hpp"
#include "equidem/grains/neighbours/near_pairs.hpp"
#include "equidem/grains/neighbours/near_parts.hpp"
#include "equidem/grains/neighbours/neighbours.hpp"
#include "equidem/grains/scene/grain_parts.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/grains/scene/wall_joints.hpp"

namespace equidem {

struct GrainMotion {
  Vec2 position, velocity;
  double spin = 0, angle = 0;
};

/// What does not change; walls have the inverse mass 0.
struct GrainBody {
  double radius = 0, inverse_mass = 0, inverse_moment = 0;
  std::int32_t kind = 0;
};

/// What contacts give a body in one step.
struct alignas(32) BodyImpulse {
  Vec2 impulse;       ///< N s
  double torque = 0;  ///< impulse of the moment, N m s
  double rim = 0;     ///< impulse along the rim of a disc by near pairs, N s; the move of bodies makes a torque of it
};

/// Two bodies near enough to touch soon, or a body and a wall, with what their contact remembers.
struct Candidate {
  // what every step looks at comes first: bodies that are near but do not touch cost one line of the cache
  std::int32_t i = 0;
  std::int32_t j = 0;  ///< ~j: a wall, where negative
  bool touching = false;
  bool parted = false;      // a map ended it with the step: what overlaps then is a new contact
  bool attraction = false;  // does not change, like the next three
  bool covered = false;     // with the end of a wall, where another wall goes on: does nothing (wall_joints.hpp)
  int mode = 0;
  double reduced_mass = 0;
  double a = 0;  // dimensionless stiffness
  /// Force laws: dashpot coefficient over m/dt, Law::dissipation sqrt(a); others: Law::dissipation.
  double dissipation = 0;
  std::int64_t steps = 0;
  // of the last step
  double overlap = 0, closing = 0;
  Vec2 normal;
  double impulse = 0, moment = 0, tangential_impulse = 0;
  // springs
  double stretch = 0;    // of the tangential one, m
  double stiffness = 0;  // N/m, hertz: N/m^(3/2); does not change
  Sliding sliding;       // does not change
};

/// A wall where it is now and how it moves in this step.
struct WallPlace {
  Vec2 displacement;
  Vec2 velocity;  ///< mean over the step
  /// That contacts see and walls do work with: velocity_verlet, whose forces act half in the step before, the mean over
  /// both.
  Vec2 acting_velocity;
  Vec2 passed_velocity;  ///< velocity_verlet: mean over the step before
};

/// The bodies in the order of their places.
struct Bodies {
  std::vector<GrainBody> constants;
  std::vector<GrainMotion> motions;
  std::vector<GrainMotion> next;  ///< after the step being made
  std::vector<BodyImpulse> impulses;
  std::vector<BodyImpulse> impulses_before;  ///< of the step before, where friction asks for them
  /// maps: mass times shift of the position, kg m; exact_flow: integral of (dt - t) force dt, N s²; other laws: empty
  std::vector<Vec2> moments;
  std::vector<std::size_t> grain_of;         ///< caller's number of the k-th
  std::vector<std::int32_t> place_of_grain;  ///< its inverse
};

/// Ellipses and clumps; all empty in scenes of discs alone.
struct Shapes {
  std::vector<GrainPart> parts;          ///< of body k: from first_part[k] to first_part[k + 1]
  std::vector<std::int32_t> first_part;  ///< one more than bodies
  std::vector<std::int32_t> body_of_part;
  std::vector<std::int32_t> shaped;  ///< bodies that are no discs
  std::vector<Vec2> axes;            ///< x-axis of each body where it is now
};

/// The walls in the order of their places.
struct Walls {
  std::vector<WallPlace> places;
  std::vector<WallJoints> joints;           ///< of each wall; empty where none join
  std::vector<std::size_t> wall_of;         ///< caller's number of the k-th
  std::vector<std::int32_t> place_of_wall;  ///< its inverse
};

/// Pairs that touch or may come to touch soon.
struct ContactList {
  NearPairs near;
  NearParts near_parts;
  /// That are in none of the near lists; ordered by i, then j, walls last, then parts.
  std::vector<Candidate> candidates;
  std::vector<ExactPair> exact_pairs;  ///< simultaneous laws: one for each candidate
  std::vector<PartPair> part_pairs;    ///< scenes with shapes: one for each candidate
  NeighbourFinder finder;
  std::vector<Circle> circles;   ///< bodies, for the finder
  double margin = 0, moved = 0;  ///< of the candidates; how far bodies may have moved since they were found, m
  double base_margin = 0;        ///< while bodies are slow, m
};

struct BondList {
  std::vector<TiedPair> tied;  ///< ordered by i, then j
  PackedBonds packed;
};

struct GrainSystem {
  GrainScene scene;  ///< walls and grains in the order of their places
  GrainOptions options;
  double length = 0;                 ///< d_c
  std::vector<double> dissipations;  ///< Law::dissipation of scene.pairs
  bool friction = false;
  double smallest_radius = 0;  ///< of the circles that parts hold, m

  Bodies bodies;
  Shapes shapes;
  Walls walls;
  ContactList contacts;
  BondList bonds;

  std::int64_t step = 0;
  std::vector<TouchImpulse> touch_impulses;  ///< of the step being made
  bool free_flight = false;                  ///< all impulses are zero
  double longest_way = 0;                    ///< of a body in the step being made, squared, m²
  double deepest = 0;                        ///< overlap of the step, m
  EnergyLedger lost;                         ///< losses and work since the start
  GrainCounters counters;

  [[nodiscard]] const LawDescription& law() const { return describe(options.law); }
  [[nodiscard]] double dt() const { return options.time_step; }
  [[nodiscard]] double time() const { return static_cast<double>(step) * options.time_step; }
  [[nodiscard]] const PairProperties& properties(const Candidate& candidate) const {
    const int other = candidate.j >= 0 ? bodies.constants[static_cast<std::size_t>(candidate.j)].kind
                                       : scene.walls[static_cast<std::size_t>(~candidate.j)].kind;
    return scene.between(bodies.constants[static_cast<std::size_t>(candidate.i)].kind, other);
  }
  [[nodiscard]] double dissipation(const Candidate& candidate) const {
    return dissipations[static_cast<std::size_t>(&properties(candidate) - scene.pairs.data())];
  }
};

/// Put grains and walls in the order of their places, so that the caller's order changes no bit.
void order_by_place(GrainSystem& system, const GrainScene& scene);

/// Law::dissipation of the pairs of kinds.
void find_dissipations(GrainSystem& system);

/// Coefficient of the normal dashpot of a pair under a force law: Law::dissipation sqrt(k m).
double dashpot_of(const GrainSystem& system, const Candidate& candidate);

/// Fill in what the law needs of a pair.
void set_constants(const GrainSystem& system, Candidate& candidate);

/// Find all candidates within the margin anew; contacts keep what they remember.
void find_candidates(GrainSystem& system);

/// See to it that the candidates hold all that may touch while no body moves further than `reach` from where it is, and
/// count that way as gone. \return whether they were found anew
bool refresh_candidates(GrainSystem& system, double reach);

/// The longest way that a body goes in this step, walls included.
double reach_of(const GrainSystem& system);

/// Forget a contact that has ended.
void forget_contact(GrainSystem& system, Candidate& candidate);

/// Where walls are at the start of the step, and their mean velocity over it.
void place_walls(GrainSystem& system);

}  // namespace equidem
