// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Data of the steps of colliding bodies: bodies and walls sorted by position, candidates for contact.
#pragma once

#include <cmath>
#include <cstdint>
#include <ranges>
#include <vector>

#include "equidem/contact/exact_contact.hpp"
#include "equidem/contact/sliding.hpp"
#include "equidem/geometry/neighbours.hpp"
#include "equidem/grains/cell/periodic_motion.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/kernels/bond_loop.hpp"
#include "equidem/grains/neighbours/body_blocks.hpp"
#include "equidem/grains/neighbours/near_pairs.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/grains/scene/wall_joints.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

struct GrainMotion {
  Vec2 position, velocity;
  double spin = 0, angle = 0;
};

/// Constants of a body; walls have inverse mass 0.
struct GrainBody {
  double radius = 0, inverse_mass = 0, inverse_moment = 0;
  std::int32_t kind = 0;
};

/// Constants of a contact of two bodies, or of a body and a wall.
struct ContactConstants {
  double reduced_mass = 0;        ///< kg
  double stiffness = 0;           ///< normal, N/m, hertz: N/m^(3/2)
  double a = 0;                   ///< dimensionless stiffness
  double dissipation = 0;         ///< LawFacts::dissipation
  double least = 0;               ///< least normal impulse: 0, or minus infinity if contacts may attract
  double tangential_damping = 0;  ///< 2 zeta_T sqrt(kT): the dashpot over the root of the tangential mass
  Sliding sliding;                ///< of discs that just touch, as large as the bodies

  /// Coefficient of the normal dashpot under a force law: LawFacts::dissipation sqrt(k m).
  [[nodiscard]] double dashpot() const { return dissipation * std::sqrt(stiffness * reduced_mass); }
};

/// Two discs, or a disc and a wall, that may touch soon, with the state of their contact: maps and simultaneous laws.
struct Candidate : ContactConstants {
  std::int32_t i = 0;
  std::int32_t j = 0;  ///< negative: wall ~j
  bool touching = false;
  bool parted = false;   ///< a map ended the contact in this step: a later overlap is a new contact
  bool covered = false;  ///< contact with the end of a wall that another wall continues: ignored (wall_joints.hpp)
  int mode = 0;
  std::int64_t steps = 0;
  // state after the last step
  double overlap = 0, closing = 0;
  Vec2 normal;
  double impulse = 0, moment = 0, tangential_impulse = 0;
  double stretch = 0;  ///< of the tangential spring, m
};

/// A contact as it is reported, saved and handed on.
struct ContactState : Partners {
  int mode = 0;
  bool parted = false;
  std::int64_t steps = 0;
  double overlap = 0, closing = 0;
  Vec2 normal = {};
  double impulse = 0, moment = 0, tangential_impulse = 0, stretch = 0;
  Vec2 arm_i = {}, arm_j = {};                      ///< from the centres of mass to the contact point, m; {} for a wall
  double rolling_stretch = 0, rolling_impulse = 0;  ///< as in ContactEffects
  double lever = 0;                                 ///< R of rolling, m; not saved
};

/// Displacement and velocity of a wall in the present step.
struct WallPlace {
  Vec2 displacement;
  Vec2 velocity;  ///< mean over the step
  /// Velocity used for contacts and for the work of walls. velocity_verlet: mean over this and the previous step, since
  /// forces act half in each.
  Vec2 acting_velocity;
  Vec2 passed_velocity;  ///< velocity_verlet: mean over the previous step
};

/// The impulses of bodies on a wall; work since the start.
struct WallLoad {
  Vec2 impulse, step_impulse;  ///< since the start without the present step, in this one; N s
  double step_angular = 0;     ///< about the place of the wall, N m s
  double work = 0;             ///< done by the wall, J

  void add_in_step(const WallLoad& other) {
    step_impulse += other.step_impulse;
    step_angular += other.step_angular;
    work += other.work;
  }
  void begin_step() {
    impulse += step_impulse;
    step_impulse = {};
    step_angular = 0;
  }
};

/// The sums of a step to which every contact adds.
struct ContactSums {
  EnergyLedger& lost;               ///< losses and work since the start
  std::vector<WallLoad>* on_walls;  ///< of each wall; may be empty where no wall is touched
};

/// Sums over the contacts of a block in a step.
struct BlockSums {
  EnergyLedger lost;
  std::vector<WallLoad> on_walls;              ///< empty: none of its bodies is near a wall
  std::int64_t evaluations = 0, contacts = 0;  ///< as in GrainCounters
  double deepest = 0;                          ///< deepest overlap, m
  ImageImpulses on_images;

  [[nodiscard]] ContactSums sums() { return {lost, &on_walls}; }
};

/// What a servo wall goes on from at the start of a step.
struct ServoMotion : ControlState {
  double way = 0;           ///< m
  double passed_speed = 0;  ///< in the step before, m/s
  double free_way = 0;      ///< m, since the wall last touched a body
  bool touched = false;     ///< it has touched one
  double farthest = 0;      ///< limit of free_way: the extent of all bodies and walls where the servo began, m
};

struct ServoState : ServoMotion {
  std::size_t wall = 0, mirror = 0;  ///< places of the walls; equal: no mirror
  std::size_t between[2] = {};       ///< places of the walls between which the length is measured
  double speed_of_push = 0;          ///< m/s, if the speed is not given: at which a body pushes by 1 N
};

/// The bodies sorted by position.
struct GrainBodies {
  BodyBlocks blocks;
  std::vector<BlockSums> sums;        ///< of each block
  std::vector<double> ways;           ///< of each block: square of the longest displacement in the present step, m²
  std::vector<std::size_t> earliest;  ///< of each block: the first one with a near pair that acts on it
  std::vector<std::vector<InwardImpulse>> inwards;  ///< of each block: impulses by near pairs of earlier blocks
  std::vector<GrainBody> constants;
  std::vector<GrainMotion> motions;
  std::vector<GrainMotion> next;  ///< motions after the present step
  bool moved = false;             ///< those after the present step stand in `motions`, and `next` is not used
  std::vector<BodyImpulse> impulses;
  bool at_zero = false;                      ///< the impulses, once the bodies of a block have moved
  std::vector<BodyImpulse> impulses_before;  ///< of the previous step; stored if candidate_loop() needs them
  /// Maps: mass times shift of the position, kg m. exact_flow: integral of (dt - t) force dt, N s². Other laws: empty.
  std::vector<Vec2> moments;
  std::vector<std::size_t> order;            ///< numbers of all, absent ones too
  std::vector<std::size_t> grain_of;         ///< caller's number of the k-th that is present
  std::vector<std::int32_t> place_of_grain;  ///< its inverse; -1: absent
};

/// Ellipses and clumps; all empty in scenes of discs alone.
struct Shapes {
  std::vector<GrainPart> parts;          ///< parts of body k: first_part[k] .. first_part[k + 1] - 1
  std::vector<std::int32_t> first_part;  ///< an entry more than there are bodies
  std::vector<std::int32_t> body_of_part;
  std::vector<std::int32_t> shaped;  ///< bodies that are not discs
  std::vector<Vec2> axes;            ///< present x-axis of each body
};

/// The walls sorted by position.
struct Walls {
  std::vector<Wall> given;  ///< those of the scene are joined (wall_joints.hpp)
  std::vector<WallPlace> places;
  std::vector<WallLoad> loads;
  std::vector<ServoState> servos;
  std::vector<WallJoints> joints;           ///< joints of each wall; empty if no walls join
  std::vector<std::size_t> wall_of;         ///< caller's number of the k-th
  std::vector<std::int32_t> place_of_wall;  ///< its inverse
};

/// Pairs that touch or may touch soon.
struct ContactList {
  std::array<NearLists, 4> near;  ///< force laws: in the order of Between
  std::optional<PairLaw> law;     ///< as common_law()
  bool record = false;            ///< record the present step for contacts()
  NearPairs pairs;
  NearParts parts;
  /// Contacts by maps and simultaneous laws, ordered by i, then j (walls last).
  std::vector<Candidate> candidates;
  std::vector<ExactPair> exact_pairs;  ///< simultaneous laws: one for each candidate
  NeighbourFinder finder;
  const NeighbourList* neighbours = nullptr;  ///< list of the finder
  PairFinder finder_in_cell;
  NeighbourList in_cell;              ///< `begin` of `images` instead of partners
  std::vector<PeriodicImage> images;  ///< partners of all bodies, ascending within each
  std::vector<Circle> circles;        ///< bodies, for the finder
  Skin skin;                          ///< of the list of the finder
  double base_margin = 0;             ///< margin for slow bodies, m

  [[nodiscard]] NearLists& of(Between between) { return near[static_cast<std::size_t>(between)]; }
  [[nodiscard]] const NearLists& of(Between between) const { return near[static_cast<std::size_t>(between)]; }
  [[nodiscard]] bool has(Between between) const { return of(between).active(); }
  /// The p-th partner in `neighbours`.
  [[nodiscard]] PeriodicImage neighbour(std::int64_t p) const {
    return images.empty() ? PeriodicImage{neighbours->partner[p]} : images[p];
  }
};

struct BondList {
  std::vector<TiedPair> tied;  ///< broken ones too; ordered by i, then j
  std::size_t held = 0;        ///< number of those that have not broken
  PackedBonds packed;
  bool breakable = false;         ///< bonds have strengths
  double friction = 0;            ///< of the strengths
  bool beside_contact = false;    ///< likewise: bonded discs touch as others do
  std::vector<BondBreak> breaks;  ///< in the order of time

  /// The bonds that have not broken.
  [[nodiscard]] auto holding() const {
    return tied | std::views::filter([](const TiedPair& bond) { return !bond.broken; });
  }
};

struct GrainSystem {
  GrainScene scene;  ///< walls sorted by position
  GrainOptions options;
  double length = 0;                 ///< d_c
  std::vector<double> dissipations;  ///< LawFacts::dissipation of scene.pairs
  bool friction = false;             ///< contacts turn bodies: they have friction, or effects
  bool rolling = false, cohesion = false;
  double range = 0;            ///< the largest of cohesion, m
  double smallest_radius = 0;  ///< smallest radius of the inscribed circles of all parts, m

  GrainBodies bodies;
  Shapes shapes;
  Walls walls;
  ContactList contacts;
  BondList bonds;
  MovingCell cell;

  std::int64_t step = 0;
  double longest_way = 0;  ///< square of the longest displacement of a body in the present step, m²
  double deepest = 0;      ///< deepest overlap of the present step, m
  EnergyLedger lost;       ///< losses and work since the start
  GrainCounters counters;

  [[nodiscard]] ContactSums sums() { return {lost, &walls.loads}; }
  [[nodiscard]] const LawDescription& law() const { return describe(options.law); }
  [[nodiscard]] double dt() const { return options.time_step; }
  [[nodiscard]] bool has_effects() const { return rolling || cohesion; }
  /// Time from that of the velocities to that of the positions, s, under a force law.
  [[nodiscard]] double lag() const { return options.verlet() ? 0 : 0.5 * options.time_step; }
  [[nodiscard]] double time() const { return static_cast<double>(step) * options.time_step; }
  [[nodiscard]] const Grain& grain(std::int32_t body) const { return scene.grains[bodies.grain_of[body]]; }
  /// A part of a body; in scenes of discs the body.
  [[nodiscard]] GrainPart part(std::int32_t body, std::int32_t number) const {
    const double radius = bodies.constants[body].radius;
    return shapes.parts.empty() ? GrainPart{{}, radius, radius, radius} : shapes.parts[number];
  }
  /// The properties of the contact of a body with another one, or with a wall ~j.
  [[nodiscard]] const PairProperties& properties(std::int32_t i, std::int32_t j) const {
    const int other = j >= 0 ? bodies.constants[j].kind : scene.walls[~j].kind;
    return scene.between(bodies.constants[i].kind, other);
  }
  /// From the centre of i to that of the image of j at the start of the step.
  [[nodiscard]] Vec2 branch(const Partners& of) const {
    return bodies.motions[of.j].position - bodies.motions[of.i].position + cell.now.shift(of.image());
  }
};

/// Sort grains and walls by position, so that results do not depend on the caller's order; absent grains follow.
/// \param order that the grains take instead, as GrainBodies::order; empty: by position
void order_by_place(GrainSystem& system, const GrainScene& scene, const std::vector<std::size_t>& order);

/// Compute LawFacts::dissipation for every pair of kinds.
void find_dissipations(GrainSystem& system);

/// \param j a body, or a wall ~j
ContactConstants constants_of(const GrainSystem& system, std::int32_t i, std::int32_t j);

/// \param j as in constants_of \param stiffness of its contact with i
EffectConstants effects_between(const GrainSystem& system, std::int32_t i, std::int32_t j, double stiffness);

/// Connect the impulses of pairs with bodies of later blocks, when lists of near pairs have been found, and set
/// GrainBodies::earliest.
void connect_blocks(GrainSystem& system);

/// Find all pairs within the margin again; existing contacts keep their state.
void find_candidates(GrainSystem& system);

/// Ensure that the candidates contain every pair that may touch while no body moves further than `reach`, and add
/// `reach` to the motion counted. \return whether the candidates were found again
bool refresh_candidates(GrainSystem& system, double reach);

/// The contacts of pairs of discs, of parts, of walls.
std::vector<ContactState> contact_states(const GrainSystem& system);

/// Longest displacement of a body or wall in this step, m.
double reach_of(const GrainSystem& system);

/// Reset the state of a contact that has ended; what its tangential spring stored is lost.
void forget_contact(Candidate& candidate, EnergyLedger& lost);

/// Count an impulse of a body on a wall, and the work that the wall does on the body.
/// \param wall as Candidate::j
/// \param point at which it acts, m
/// \param velocity of the wall, m/s
/// \param couple angular impulse besides, N m s
inline void push_wall(const GrainSystem& system, std::int32_t wall, Vec2 point, Vec2 impulse, Vec2 velocity,
                      ContactSums sums, double couple = 0) {
  const auto w = static_cast<std::size_t>(~wall);
  WallLoad& load = (*sums.on_walls)[w];
  const double work = -dot(impulse, velocity);
  sums.lost.work_of_walls += work;
  load.work += work;
  load.step_impulse += impulse;
  load.step_angular +=
      cross(point - (system.walls.given[w].point + system.walls.places[w].displacement), impulse) + couple;
}

/// Set the displacement of walls at the start of the step and their mean velocity over it.
void place_walls(GrainSystem& system);

}  // namespace equidem
