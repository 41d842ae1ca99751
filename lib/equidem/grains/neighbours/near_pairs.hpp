// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Search for the contacts of a force law, and bodies as the loops over them read them.
///
/// Near pairs are a subset of the list of the neighbour finder, with a smaller skin and updated more often: in a
/// packing at rest they are hardly more than the contacts. The circles round slender ellipses overlap those of many
/// others; an intermediate list of close parts therefore uses boxes round both, each pair checked again only after
/// bodies have moved by its gap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/grains/neighbours/contact_list.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

struct GrainBody;
struct GrainMotion;

/// The margin of a list, which holds until bodies have moved so far.
struct Skin {
  double margin = 0, moved = 0;  ///< moved: upper bound of the motion since the list was found, m

  /// Whether the list still contains every pair that may touch where bodies move by `reach`.
  [[nodiscard]] bool holds(double reach) const { return 2 * (moved + reach) <= margin; }
};

/// Data of a body for the loop over pairs, in loading order.
struct alignas(64) PairBody {
  Vec2 position, velocity;
  /// Velocity plus half the change by the contacts in the last step: predicts the mean over the step.
  Vec2 middle_velocity;
  double middle_rim_speed = 0;
  double rim_speed = 0;  ///< spin times radius
};

/// Data of a part for the loop over pairs, in the two rows in which it is loaded.
struct alignas(64) PartBody {
  /// Centre of the part; velocity of the body; velocity plus half the change by contacts in the last step.
  Vec2 centre, velocity, middle_velocity, unused = {};
  double spin = 0, middle_spin = 0;
  Vec2 turned;  ///< ellipse: the axis; round part: the offset of its centre from that of the body, m
};

struct NearPairs {
  LaneVector<PairBody> bodies;
  Skin skin;
};

struct NearParts {
  /// Two parts that may touch while the list of the neighbour finder is valid.
  struct Close {
    PairKey pair;
    double clear = 0;  ///< lower bound of the gap plus twice `travelled`, m
    Vec2 apart;        ///< a direction along which they were apart, or {}
  };

  std::vector<std::vector<Close>> close;  ///< of each block, ordered by pair
  LaneVector<PartBody> bodies;            ///< one for each part
  std::vector<char> met;                  ///< whether a part is in the lists
  double size = 0;                        ///< smallest GrainPart::size, m
  Skin skin;
  /// Upper bound of the displacement of any point from the construction of `close` to that of the lists, m.
  double travelled = 0;

  [[nodiscard]] std::size_t bytes() const;
};

/// Set the parts of all bodies and their axes if the scene has ellipses or clumps.
void place_parts(GrainSystem& system);
/// Prepare what the loops read of bodies.
void prepare_bodies(GrainSystem& system);

/// Whether both bodies of a pair are whole discs, so that it is not a pair of parts.
bool are_discs(const GrainSystem& system, std::int32_t i, std::int32_t j);
/// The list of a pair of parts.
Between between_parts(const GrainSystem& system, std::int32_t p, std::int32_t q);

/// Find the near lists again in the list of the neighbour finder.
void find_near_lists(GrainSystem& system);
/// Ensure that they contain every pair that may touch while no point of a body moves further than `reach`.
void refresh_near_lists(GrainSystem& system, double reach);
/// Find the pairs of discs of some blocks again, where bodies may touch that were bonded; of the same margin.
void find_near_pairs_of(GrainSystem& system, std::vector<std::size_t> blocks);

/// Load the data of the loops from the motions and the impulses of the last step.
void load_pair_bodies(GrainSystem& system);
void load_part_bodies(GrainSystem& system);

/// As move_by_euler() for a block, with the body data of the loop for the next step. GrainBodies::moved and
/// GrainBodies::at_zero say where motions go and what is left of the impulses.
void move_pair_bodies(GrainSystem& system, std::size_t block);

/// Update the axes to the present angles of the bodies.
void turn_axes(GrainSystem& system);

/// Upper bound of the displacement of a point of a body by its rotation in the step, m; discs excluded.
double longest_turn(const GrainSystem& system);

}  // namespace equidem
