// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Joints of walls. Ends that nearly meet are one point: a body over the gap would be pushed by both. At a joint only
/// one wall has a contact with a grain: two contacts at one point would double stiffness and losses.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "equidem/motion/wall.hpp"

namespace equidem {

struct GrainSystem;

/// Largest gap of walls that join, over the smallest radius; at most this share of the length of either wall too.
constexpr double joint_gap = 1e-2;

/// An end of a wall that lies on another wall, which moves with it.
struct WallJoint {
  std::int32_t wall = 0;  ///< index of the other wall
  int end = 0;            ///< end of the other wall, 1 or 2; 0: between its ends
  double reach = 0;       ///< largest gap for these two, m: contacts so near to the joint are at one point
};

/// Joints of the first and of the second end of a wall.
using WallJoints = std::array<std::vector<WallJoint>, 2>;

/// Ends that nearly meet end in one point, their mean; ends that nearly lie on another wall end there. What lies
/// together to rounding stays as it is.
/// \param tolerance largest gap of walls that join, m
std::vector<Wall> joined_walls(std::span<const Wall> walls, double tolerance);

/// \param walls joined_walls of the same tolerance
/// \return one for each wall; empty if no walls join
std::vector<WallJoints> joints_of(std::span<const Wall> walls, double tolerance);

/// Walls that coincide over some length, where every contact would be counted twice.
std::optional<std::pair<std::size_t, std::size_t>> coinciding_walls(std::span<const Wall> walls, double tolerance);

/// A sentence for each pair of ends that do not join, although their gap is less than a fifth of the smallest radius: a
/// body over it is pushed by both walls.
std::vector<std::string> gaps_of_walls(std::span<const Wall> given, double smallest_radius);

/// Find the contacts with ends of walls that are covered by a contact with a wall that continues there; these are
/// ignored. The state of such a contact passes to the contact that replaces it.
void cover_joints(GrainSystem& system);

}  // namespace equidem
