// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pairs of discs under a force law that touch or nearly touch, packed in groups of eight for the vectorized loop.
///
/// They are a subset of the list of the neighbour finder, with a smaller margin and updated more often: in a packing at
/// rest it contains hardly more than the contacts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/geometry/neighbours.hpp"
#include "equidem/grains/neighbours/contact_list.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

struct GrainSystem;
struct ContactState;
struct GrainBody;
struct GrainMotion;

/// Data of a body for the loop over pairs, in loading order.
struct alignas(64) PairBody {
  Vec2 position, velocity;
  /// Velocity plus half the change by the contacts in the last step: predicts the mean over the step.
  Vec2 middle_velocity;
  double middle_rim_speed = 0;
  double rim_speed = 0;  ///< spin times radius
};

/// Eight pairs i < j; j: a body, or an image (periodic_images.hpp).
struct PairGroup : ContactGroup {
  PairLanes reach;          ///< r_i + r_j, m; of lanes without a pair negative, so that they never touch
  PairLanes dashpot;        ///< normal, times dt; kg, hertz: kg/m^(1/4)
  PairLanes half_mobility;  ///< (1/m_i + 1/m_j)/2
  PairLanes impulse;        ///< normal, of the last step, N s
};

/// Friction data of the pairs of a PairGroup. Half the mobility along the contact: PairGroup::half_mobility +
/// half_turning * distance².
struct alignas(64) PairSlips {
  PairLanes half_turning;  ///< (r_i²/I_i + r_j²/I_j)/(r_i + r_j)²/2
  PairLanes dashpot;       ///< times dt, kg
  PairLanes stretch;       ///< m
  PairLanes impulse;       ///< tangential, on j, of the last step, N s
};

/// Law constants if all pairs have the same.
struct PairLaw {
  double stiffness = 0;             ///< N/m, hertz: N/m^(3/2)
  double least = 0;                 ///< least normal impulse: 0, or minus infinity if contacts may attract
  double friction = 0;              ///< mu
  double tangential_stiffness = 0;  ///< N/m
};
struct alignas(64) PairLaws {
  PairLanes stiffness, least, friction, tangential_stiffness;
};

/// Data of the last step for contacts().
struct alignas(64) PairRecords {
  PairLanes overlap, closing, normal_x, normal_y;
};

struct PairBlock : GroupList<PairGroup> {
  bool friction = false, equal = false;  ///< which columns there are
  LaneVector<PairSlips> slips;           ///< with friction
  LaneVector<PairLaws> laws;             ///< law of each pair, if not equal
  LaneVector<PairRecords> records;       ///< set after a recorded step

  PairBlock emptied();
  void add_group();
  void copy(const PairBlock& other, std::size_t from, std::size_t to);
  [[nodiscard]] std::size_t bytes() const;
};

struct NearPairs {
  using Loop = void (*)(GrainSystem& system, std::size_t block);

  bool active = false;  ///< the scene has such pairs
  bool equal = false;   ///< one law for all pairs
  bool record = false;  ///< record the present step for contacts()
  PairLaw law;          ///< law of all pairs, if equal
  Loop loop = nullptr;
  const NeighbourList* outer = nullptr;  ///< list of the finder, with the margin of the candidates
  LaneVector<PairBody> bodies;
  std::vector<PairBlock> blocks;
  double margin = 0, moved = 0;  ///< margin of these pairs; upper bound of the motion since they were found, m

  [[nodiscard]] std::size_t bytes() const;
};

/// The law of all pairs of grains, where they have the same one, and contacts stick by a spring if there is friction.
std::optional<PairLaw> common_law(const GrainSystem& system);

/// Margin of near lists, for bodies of a size (discs: the radius) that move by about `reach` in a step.
double margin_of_near_pairs(const GrainSystem& system, double size, double reach);

/// Determine whether contacts of discs use the loop over near pairs, and choose the loop.
void prepare_near_pairs(GrainSystem& system);

/// Find the pairs again in the list of the neighbour finder, for bodies that move by about `reach` in a step.
void find_near_pairs(GrainSystem& system, double reach);

/// Likewise those of some blocks, where bodies may touch that were bonded; of the same margin.
void find_near_pairs_of(GrainSystem& system, std::vector<std::size_t> blocks);

/// Ensure that the list contains every pair that may touch while no body moves further than `reach`.
void refresh_near_pairs(GrainSystem& system, double reach);

/// Load the body data of the loop from the motions and the impulses of the last step.
void load_pair_bodies(GrainSystem& system);

/// Mark the bodies that overlap as touching.
void touch_near_pairs(GrainSystem& system);

/// As move_by_euler() for a block, with the body data of the loop for the next step. GrainBodies::in_place and
/// GrainBodies::cleared say where motions go and what is left of the impulses.
void move_pair_bodies(GrainSystem& system, std::size_t block);

/// The state of a contact.
ContactState state_of(const GrainSystem& system, const PairBlock& block, std::size_t p);

/// Energies of the normal and the tangential springs of the pairs at the present positions, J.
std::pair<double, double> elastic_of_near_pairs(const GrainSystem& system);

/// Energies of rolling and of cohesion of the pairs, J, the latter at the time of the velocities.
std::pair<double, double> effects_of_near_pairs(const GrainSystem& system);

/// Replace the pairs by these contacts; j may be an image.
void take_near_pairs(GrainSystem& system, std::vector<ContactState> contacts);

/// The loop compiled for the law of the scene; it computes the impulses of this step by the pairs of a block.
NearPairs::Loop near_pair_loop(const GrainSystem& system);

}  // namespace equidem
