// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Where walls join, a grain meets one of them: two contacts with one point would be twice as stiff and lose twice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "equidem/grains/scene/wall_shape.hpp"

namespace equidem {

struct GrainSystem;

/// Of the smallest radius: walls no further apart join.
constexpr double joint_gap = 1e-6;

/// An end of a wall that lies on another wall, which moves with it.
struct WallJoint {
  std::int32_t wall = 0;  ///< the other one
  int end = 0;            ///< of the other one, 1 or 2; 0: between its ends
};

/// Of the first and of the second end of a wall.
using WallJoints = std::array<std::vector<WallJoint>, 2>;

/// \param tolerance gaps no wider than this are none, m
/// \return one for each wall; empty where no walls join
std::vector<WallJoints> joints_of(std::span<const Wall> walls, double tolerance);

/// Walls that lie on one another for some length, where every contact would be counted twice; parts of arcs are not
/// looked at.
std::optional<std::pair<std::size_t, std::size_t>> coinciding_walls(std::span<const Wall> walls, double tolerance);

/// Find out which contacts with ends of walls are covered by a contact with a wall that goes on there; these do
/// nothing. What such a contact remembers goes over to the one that takes its place.
void cover_joints(GrainSystem& system);

}  // namespace equidem
