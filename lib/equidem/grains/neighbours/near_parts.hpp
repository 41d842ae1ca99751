// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pairs of parts of which not both are whole discs: those that touch or nearly touch, packed by eights for the loops
/// over them.
///
/// One list for each shape of pair: round parts (of clumps, and discs that meet them), and pairs with an ellipse; empty
/// where the scene has none. As the near pairs of discs they are lists within that of the neighbour finder, found anew
/// more often. The circles round needles overlap those of many others: between the two stand the close parts, by boxes
/// round both, each looked at again only when bodies have moved by what lay between them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "equidem/grains/neighbours/near_pairs.hpp"
#include "equidem/grains/scene/grain_parts.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

/// What pairs need of a part, in the two rows in which it is loaded.
struct alignas(64) PartBody {
  /// Centre of the part, velocity of the body, and that with half of what its contacts did in the last step.
  Vec2 centre, velocity, middle_velocity, unused = {};
  double spin = 0, middle_spin = 0;
  Vec2 turned;  ///< of an ellipse the axis; of what is round, whose axis does not matter, the offset of the centre from
                ///< that of the body, m
};

/// Eight pairs of parts, i < j.
struct alignas(64) PartGroup {
  enum Column {
    // do not change
    reach,  ///< a_i + a_j, m
    a_i,
    b_i,
    a_j,
    b_j,           ///< half-axes, m
    share,         ///< of i in the overlap
    arrived,       ///< angle at which Newton's way has arrived (contact_of_ellipses)
    sharpest,      ///< b_i²/a_i + b_j²/a_j, m: overlaps less deep have one normal alone
    inverse_mass,  ///< 1/m_i + 1/m_j
    inverse_moment_i,
    inverse_moment_j,  ///< 1/I
    stiffness,         ///< N/m, hertz: N/m^(3/2)
    dashpot,           ///< normal; N s/m, hertz: N s/m^(5/4)
    least,             ///< of the normal impulse: 0, or minus infinity where contacts may attract
    friction,
    tangential_stiffness,
    tangential_damping,  ///< as PartPair::tangential_damping
    beyond_cap,          ///< share of the dashpot that adds to what friction carries: 0 or 1
    // of the last step
    normal_x,
    normal_y,  ///< apart: a direction along which they were apart, or {}
    impulse,
    tangential_impulse,  ///< N s
    stretch,             ///< m
    // where NearPairs::record asks for them
    overlap,
    closing,
    arm_i_x,
    arm_i_y,
    arm_j_x,
    arm_j_y,
    columns
  };
  std::int32_t i[lanes_of_pairs], j[lanes_of_pairs];  ///< parts
  std::int64_t since[lanes_of_pairs];                 ///< as PairGroup::since
  PairLanes numbers[columns];
};

struct NearParts {
  struct List {
    using Loop = void (*)(GrainSystem& system, List& list);
    Loop loop = nullptr;
    LaneVector<PartGroup> groups;
    std::size_t count = 0;
    [[nodiscard]] bool touching(std::size_t p) const {
      return groups[p / lanes_of_pairs].since[p % lanes_of_pairs] > PairGroup::apart;
    }
  };

  /// Two parts that may come to touch while the list of the neighbour finder lasts.
  struct Close {
    std::int32_t i = 0, j = 0;
    double clear = 0;  ///< they are apart by at least this less twice `travelled`, m
    Vec2 apart;        ///< a direction along which they were apart, or {}
  };

  bool active = false;            ///< the scene has such pairs
  std::array<List, 2> lists;      ///< round parts, ellipses
  std::vector<Close> close;       ///< ordered by i, then j
  LaneVector<PartBody> bodies;    ///< one for each part
  std::vector<std::int32_t> met;  ///< parts that are in the lists
  double size = 0;                ///< smallest GrainPart::size, m
  double margin = 0, moved = 0;   ///< of the lists, m
  double travelled = 0;  ///< way of any point since the close parts were found until the lists were, at most, m

  [[nodiscard]] std::size_t bytes() const;
};

/// Decide whether parts meet in the loops over near parts: a law that gives a force, the exact contact, no contact that
/// slides always.
void prepare_near_parts(GrainSystem& system);

/// Find the close parts and the pairs anew among those of the neighbour finder, for bodies that move by about `reach`
/// in a step.
void find_near_parts(GrainSystem& system, double reach);

/// See to it that they hold all that may touch while no point of a body moves further than `reach` from where it is.
void refresh_near_parts(GrainSystem& system, double reach);

/// What the loops read, from the motions and the impulses of the last step.
void load_part_bodies(GrainSystem& system);

/// Parts that overlap now touch.
void touch_near_parts(GrainSystem& system);

/// A pair with all that its contact remembers.
std::pair<Candidate, PartPair> candidate_of(const GrainSystem& system, const NearParts::List& list, std::size_t p);

/// Whether the two bodies of a pair are whole discs, so that it is none of parts.
bool are_discs(const GrainSystem& system, std::int32_t i, std::int32_t j);

/// Take over contacts of a saved state, in the order of the lists, in place of what pairs there are.
void take_near_parts(GrainSystem& system, std::span<const std::pair<Candidate, PartPair>> contacts);

/// The loop compiled for pairs of a shape: impulses of this step.
NearParts::List::Loop near_part_loop(const GrainSystem& system, bool round);

}  // namespace equidem
