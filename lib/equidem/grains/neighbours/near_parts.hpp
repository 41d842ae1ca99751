// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pairs of parts, not both whole discs, and contacts with walls, that touch or nearly touch, packed in groups of eight
/// for the vectorized loops.
///
/// One list for each shape of pair: round parts (of clumps, and discs that meet them), and pairs with an ellipse; empty
/// where the scene has none. Like the near pairs of discs they are subsets of the list of the neighbour finder, updated
/// more often. The circles round slender ellipses overlap those of many others; an intermediate list of close parts
/// therefore uses boxes round both, each pair checked again only after bodies have moved by its gap.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "equidem/grains/neighbours/near_pairs.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

/// Data of a part for the loop over pairs, in the two rows in which it is loaded.
struct alignas(64) PartBody {
  /// Centre of the part; velocity of the body; velocity plus half the change by contacts in the last step.
  Vec2 centre, velocity, middle_velocity, unused = {};
  double spin = 0, middle_spin = 0;
  Vec2 turned;  ///< ellipse: the axis; round part: the offset of its centre from that of the body, m
};

/// Eight pairs of parts, i < j; that of j may be of an image. With walls: j the wall, and in scenes of discs i the
/// body.
struct PartGroup : ContactGroup {
  enum Column {
    // of the last step
    impulse,
    tangential_impulse,  ///< N s
    stretch,             ///< m
    // constants
    tangential_damping,  ///< as ContactConstants::tangential_damping
    dashpot,             ///< normal; N s/m, hertz: N s/m^(5/4)
    inverse_mass,        ///< 1/m_i + 1/m_j
    inverse_moment_i,
    inverse_moment_j,  ///< 1/I
    share,             ///< share of i in the overlap
    reach,             ///< a_i + a_j, m
    a_i,
    a_j,
    b_i,
    b_j,       ///< half-axes, m
    arrived,   ///< angle at which Newton's iteration has converged (contact_of_ellipses)
    sharpest,  ///< b_i²/a_i + b_j²/a_j, m: shallower overlaps have a unique normal
    // of the last step; of round parts only if NearPairs::record, and in Verlet schemes
    normal_x,
    normal_y,  ///< apart: a direction along which they were apart, or {}
    // constants of the law, not read where NearParts::law is set and there is friction
    stiffness,  ///< N/m, hertz: N/m^(3/2)
    least,      ///< least normal impulse: 0, or minus infinity if contacts may attract
    friction,
    tangential_stiffness,
    // set if NearPairs::record
    overlap,
    closing,
    arm_i_x,
    arm_i_y,
    arm_j_x,
    arm_j_y,
    columns,
    covered = share  ///< walls: not 0 where a wall continues the end of this one (wall_joints.hpp)
  };
  PairLanes numbers[columns];
};

struct NearParts {
  struct List : GroupList<PartGroup> {
    bool of_walls = false;

    [[nodiscard]] std::size_t wall(std::size_t p) const { return static_cast<std::size_t>(second(p)); }
    [[nodiscard]] double& number(std::size_t p, PartGroup::Column column) {
      return group(p).numbers[column][p % lanes_of_pairs];
    }
    [[nodiscard]] double number(std::size_t p, PartGroup::Column column) const {
      return group(p).numbers[column][p % lanes_of_pairs];
    }
    List emptied();
    void add_group();
    void copy(const List& other, std::size_t from, std::size_t to);
    /// End a contact; what its tangential spring held is counted nowhere.
    void end(std::size_t p);
    /// Give the state of a contact to another one.
    void move_state(std::size_t from, std::size_t to);
  };
  using Loop = void (*)(GrainSystem& system, List& list, std::size_t block);

  /// Two parts that may touch while the list of the neighbour finder is valid.
  struct Close {
    std::int32_t i = 0, j = 0;
    double clear = 0;  ///< lower bound of the gap plus twice `travelled`, m
    Vec2 apart;        ///< a direction along which they were apart, or {}
  };

  struct Block {
    std::array<List, 2> lists;  ///< round parts, ellipses
    std::vector<Close> close;   ///< ordered by i, then j
  };

  bool active = false;           ///< the scene has such pairs
  std::optional<PairLaw> law;    ///< of all pairs, as common_law()
  std::array<Loop, 2> loops{};   ///< of the lists of a block
  std::vector<Block> blocks;     ///< of bodies
  LaneVector<PartBody> bodies;   ///< one for each part
  std::vector<char> met;         ///< whether a part is in the lists
  double size = 0;               ///< smallest GrainPart::size, m
  double margin = 0, moved = 0;  ///< margin of the lists; upper bound of the motion since they were found, m
  double travelled =
      0;  ///< upper bound of the displacement of any point from the construction of `close` to that of the lists, m

  [[nodiscard]] std::size_t bytes() const;
};

/// Contacts of bodies with walls under a force law, in the lists of the blocks of bodies.
struct NearWalls {
  bool active = false;  ///< the scene has walls
  NearParts::Loop loop = nullptr;
  std::vector<NearParts::List> blocks;

  [[nodiscard]] std::size_t bytes() const;
};

/// Call work(list) for the lists of round parts of all blocks, then for those of ellipses.
template <class Lists, class Work>
void each_list_of_parts(Lists& near, const Work& work) {
  for (std::size_t l = 0; l < near.loops.size(); ++l) {
    for (auto& block : near.blocks) work(block.lists[l]);
  }
}
/// Then for those of walls.
template <class Contacts, class Work>
void each_list(Contacts& contacts, const Work& work) {
  each_list_of_parts(contacts.near_parts, work);
  for (auto& list : contacts.near_walls.blocks) work(list);
}

/// Prepare the lists of parts where the scene has ellipses or clumps under a force law.
void prepare_near_parts(GrainSystem& system);
/// Prepare the lists of walls under a force law.
void prepare_near_walls(GrainSystem& system);

/// Find the contacts with walls again that come nearer than the margin of the neighbour list.
void find_near_walls(GrainSystem& system);

/// Find the close parts and the pairs again in the list of the neighbour finder, for bodies that move by about `reach`
/// in a step.
void find_near_parts(GrainSystem& system, double reach);

/// Ensure that the lists contain every pair that may touch while no point of a body moves further than `reach`.
void refresh_near_parts(GrainSystem& system, double reach);

/// Load the data of the loops from the motions and the impulses of the last step.
void load_part_bodies(GrainSystem& system);

/// Mark the parts that overlap, and those that overlap walls, as touching.
void touch_near_parts(GrainSystem& system);

/// Two bodies and their parts, or a body and a wall.
struct Partners {
  std::int32_t i = 0, j = 0;            ///< j may be an image, or a wall ~j
  std::int32_t part_i = 0, part_j = 0;  ///< 0 in scenes of discs
};
Partners partners_of(const GrainSystem& system, const NearParts::List& list, std::size_t p);

/// The state of a contact.
ContactState state_of(const GrainSystem& system, const NearParts::List& list, std::size_t p);
/// In the state of a contact with an image: set the body, the part and the periods in its place.
void resolve_image(const GrainSystem& system, ContactState& state);

/// Energy of the normal spring of a contact at the present positions, and of its tangential spring, J.
std::pair<double, double> elastic_of(const GrainSystem& system, const NearParts::List& list, std::size_t p);

/// Likewise of rolling and of cohesion; the latter at the time of the velocities.
std::pair<double, double> effects_of(const GrainSystem& system, const NearParts::List& list, std::size_t p);

/// Whether both bodies of a pair, or of which they are images, are whole discs, so that it is not a pair of parts.
bool are_discs(const GrainSystem& system, std::int32_t i, std::int32_t j);

/// Replace the pairs by these contacts; j may be an image.
void take_near_parts(GrainSystem& system, std::vector<ContactState> contacts);
/// Replace the contacts with walls by those of these contacts.
void take_near_walls(GrainSystem& system, const std::vector<ContactState>& contacts);

/// The loops compiled for round parts, for ellipses by GrainOptions::EllipseLaw, and for walls; they compute the
/// impulses of this step by the contacts of a block.
NearParts::Loop loop_of_round_parts(const GrainSystem& system);
NearParts::Loop loop_of_ellipses(const GrainSystem& system);
NearParts::Loop loop_of_walls(const GrainSystem& system);

/// Set the parts of all bodies and their axes if the scene has ellipses or clumps.
void place_parts(GrainSystem& system);

/// Update the axes to the present angles of the bodies.
void turn_axes(GrainSystem& system);

/// Upper bound of the displacement of a point of a body by its rotation in the step, m; discs excluded.
double longest_turn(const GrainSystem& system);

}  // namespace equidem
