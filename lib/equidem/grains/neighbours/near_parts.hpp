// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pairs of parts, not both whole discs, that touch or nearly touch, packed in groups of eight for the vectorized
/// loops.
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

/// Eight pairs of parts, i < j.
struct alignas(64) PartGroup {
  enum Column {
    // of the last step
    impulse,
    tangential_impulse,  ///< N s
    stretch,             ///< m
    // constants
    tangential_damping,  ///< as PartPair::tangential_damping
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
    columns
  };
  std::int32_t i[lanes_of_pairs], j[lanes_of_pairs];  ///< parts; that of j may be of an image
  std::int64_t since[lanes_of_pairs];                 ///< as PairGroup::since
  PairLanes numbers[columns];
};

struct NearParts {
  /// Those of a block of bodies, ordered by i, then j.
  struct List {
    LaneVector<PartGroup> groups;
    std::size_t count = 0;
    OutwardImpulses outward;
    std::size_t first_outward = 0;  ///< first group with a body of a later block
    [[nodiscard]] bool touching(std::size_t p) const {
      return groups[p / lanes_of_pairs].since[p % lanes_of_pairs] > PairGroup::apart;
    }
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

/// Call work(list) for the lists of round parts of all blocks, then for those of ellipses.
template <class Work>
void each_list_of_parts(const NearParts& near, const Work& work) {
  for (std::size_t l = 0; l < near.loops.size(); ++l) {
    for (const NearParts::Block& block : near.blocks) work(block.lists[l]);
  }
}

/// Determine whether contacts of parts use the loops over near parts: a force law, the exact contact, no contact that
/// always slides.
void prepare_near_parts(GrainSystem& system);

/// Find the close parts and the pairs again in the list of the neighbour finder, for bodies that move by about `reach`
/// in a step.
void find_near_parts(GrainSystem& system, double reach);

/// Ensure that the lists contain every pair that may touch while no point of a body moves further than `reach`.
void refresh_near_parts(GrainSystem& system, double reach);

/// Load the data of the loops from the motions and the impulses of the last step.
void load_part_bodies(GrainSystem& system);

/// Mark the parts that overlap as touching.
void touch_near_parts(GrainSystem& system);

/// A pair with the state of its contact; j may be an image.
std::pair<Candidate, PartPair> candidate_of(const GrainSystem& system, const NearParts::List& list, std::size_t p);

/// Whether both bodies of a pair, or of which they are images, are whole discs, so that it is not a pair of parts.
bool are_discs(const GrainSystem& system, std::int32_t i, std::int32_t j);

/// Replace the pairs by these contacts; j may be an image.
void take_near_parts(GrainSystem& system, std::vector<ContactState> contacts);

/// The loop compiled for round parts or for ellipses; it computes the impulses of this step by the
/// pairs of a block.
NearParts::Loop near_part_loop(const GrainSystem& system, bool round);

/// Set the parts of all bodies and their axes if the scene has ellipses or clumps.
void place_parts(GrainSystem& system);

/// The parts of two whole discs in a scene with shapes; {} in other scenes. \param j may be an image
PartPair parts_of_discs(const GrainSystem& system, std::int32_t i, std::int32_t j);

/// Update the axes to the present angles of the bodies.
void turn_axes(GrainSystem& system);

/// Upper bound of the displacement of a point of a body by its rotation in the step, m; discs excluded.
double longest_turn(const GrainSystem& system);

/// Pairs of parts that come nearer than the margin, in their order.
std::vector<PartPair> near_parts(const GrainSystem& system, std::size_t i, std::size_t j);
/// Pairs of the parts of a body with a wall that come nearer than the margin; ellipses at a segment by their
/// bounding circle.
std::vector<PartPair> near_parts_of_wall(const GrainSystem& system, std::size_t i, std::size_t wall);

}  // namespace equidem
