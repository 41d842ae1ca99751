// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pairs of discs under a law that gives a force: those that touch or nearly touch, packed by eights for the loop over
/// them.
///
/// They are a list within the list of the neighbour finder, with a smaller margin and found anew more often: in a
/// packing at rest it holds hardly more than the contacts. Discs and walls, and all that meets by other laws, are
/// Candidates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/grains/neighbours/neighbours.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

struct GrainSystem;
struct Candidate;
struct GrainBody;
struct GrainMotion;
struct BodyImpulse;

constexpr std::size_t lanes_of_pairs = 8;
using PairLanes = double[lanes_of_pairs];

/// What pairs need of a body, in the order in which it is loaded.
struct alignas(64) PairBody {
  Vec2 position, velocity;
  double rim_speed = 0;  ///< spin times radius
  /// With half of what the contacts of the last step did: predicts the mean over the step.
  Vec2 middle_velocity;
  double middle_rim_speed = 0;
};

/// Eight pairs i < j.
struct alignas(64) PairGroup {
  static constexpr std::int64_t apart = -2, unused = -3;
  std::int32_t i[lanes_of_pairs], j[lanes_of_pairs];
  std::int64_t since[lanes_of_pairs];  ///< step before the first of the contact; `apart`: none; `unused`: no pair
  PairLanes reach;                     ///< r_i + r_j, m
  PairLanes dashpot;                   ///< normal; N s/m, hertz: N s/m^(5/4)
  PairLanes mass;                      ///< 1/m_i + 1/m_j
  PairLanes impulse;                   ///< normal, of the last step, N s
};

/// The same pairs with friction. Mobility of the contact: PairGroup::mass + turning * distance².
struct alignas(64) PairSlips {
  PairLanes turning;  ///< (r_i²/I_i + r_j²/I_j)/(r_i + r_j)²
  PairLanes dashpot;  ///< N s/m
  PairLanes stretch;  ///< m
  PairLanes impulse;  ///< tangential, of the last step, N s
};

/// What is a number for the loop where all pairs have the same.
struct PairLaw {
  double stiffness = 0;             ///< N/m, hertz: N/m^(3/2)
  double least = 0;                 ///< of the normal impulse: 0, or minus infinity where contacts may attract
  double friction = 0;              ///< mu
  double tangential_stiffness = 0;  ///< N/m
  double beyond_cap = 0;            ///< share of the dashpot that adds to what friction carries: 0 or 1
};
struct alignas(64) PairLaws {
  PairLanes stiffness, least, friction, tangential_stiffness, beyond_cap;
};

/// What contacts() tells of the last step.
struct alignas(64) PairRecords {
  PairLanes overlap, closing, normal_x, normal_y;
};

struct NearPairs {
  using Loop = void (*)(GrainSystem& system);

  bool active = false;  ///< the scene has such pairs
  bool equal = false;   ///< one law for all pairs
  bool rigid = false;   ///< friction, none with a tangential spring
  bool record = false;  ///< the step being made is one that contacts() will be asked about
  PairLaw law;          ///< where equal
  Loop loop = nullptr;
  const NeighbourList* outer = nullptr;  ///< of the finder, with the margin of the candidates
  LaneVector<PairBody> bodies;
  std::size_t count = 0;
  LaneVector<PairGroup> groups;
  LaneVector<PairSlips> slips;      ///< with friction
  LaneVector<PairLaws> laws;        ///< where not equal
  LaneVector<PairRecords> records;  ///< after a step that was to be recorded
  double margin = 0, moved = 0;     ///< of these pairs, m

  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::int32_t first(std::size_t p) const { return groups[p / lanes_of_pairs].i[p % lanes_of_pairs]; }
  [[nodiscard]] std::int32_t second(std::size_t p) const { return groups[p / lanes_of_pairs].j[p % lanes_of_pairs]; }
  [[nodiscard]] bool touching(std::size_t p) const {
    return groups[p / lanes_of_pairs].since[p % lanes_of_pairs] > PairGroup::apart;
  }
};

/// Whether contacts of parts can be computed several at a time: a law that gives a force, no contact that slides
/// always.
bool eight_at_a_time(const GrainSystem& system);

/// Margin of lists within that of the neighbour finder, for bodies of a size (of discs the radius) that move by about
/// `reach` in a step.
double margin_of_near_pairs(const GrainSystem& system, double size, double reach);

/// Decide whether discs meet in the loop over near pairs, and choose it.
void prepare_near_pairs(GrainSystem& system);

/// Find the pairs anew among those of the neighbour finder, for bodies that move by about `reach` in a step.
void find_near_pairs(GrainSystem& system, double reach);

/// See to it that they hold all that may touch while no body moves further than `reach` from where it is.
void refresh_near_pairs(GrainSystem& system, double reach);

/// What the loop reads of bodies, from their motions and the impulses of the last step.
void load_pair_bodies(GrainSystem& system);

/// Bodies that overlap now touch.
void touch_near_pairs(GrainSystem& system);

/// system.bodies.next as move_by_euler(), and what the loop reads of bodies for the next step.
void move_pair_bodies(GrainSystem& system);

/// A pair with all that its contact remembers; without what does not change.
Candidate candidate_of(const GrainSystem& system, std::size_t p);

/// What normal and tangential springs of the pairs hold as the bodies stand, J.
std::pair<double, double> elastic_of_near_pairs(const GrainSystem& system);

/// Take over contacts of a saved state, ordered by (i, j), in place of what pairs there are.
void take_near_pairs(GrainSystem& system, const std::vector<Candidate>& contacts);

/// The loop compiled for the law of the scene: impulses of this step.
NearPairs::Loop near_pair_loop(const GrainSystem& system);

}  // namespace equidem
