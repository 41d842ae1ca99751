// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Memory layout of discs and contacts in the loops.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

/// Discs are ordered in strips parallel to x, high enough that contacts connect a strip only to itself and its
/// neighbours, and within strips in groups of four whose lanes are computed at once. Strips are padded with empty
/// places.
///
/// Strips allow several steps while data are in the cache: strip l can be at step k + 1 as soon as its neighbours are
/// at step k. In an assembly periodic along y, a strip contains discs of the lower and of the upper half: the ring of
/// strips is folded flat.
struct DiscLayout {
  static constexpr int lanes = 4;

  std::vector<std::int32_t> disc_at;      ///< place -> disc, -1: none; places x lanes
  std::vector<std::int32_t> place_of;     ///< disc -> place
  std::vector<std::int32_t> strip_first;  ///< strips + 1, in groups

  [[nodiscard]] std::int32_t groups() const { return static_cast<std::int32_t>(disc_at.size() / lanes); }
  [[nodiscard]] std::int32_t strips() const { return static_cast<std::int32_t>(strip_first.size()) - 1; }
};

DiscLayout lay_out(const Assembly& assembly);

/// The contacts of every group: slot k of a group holds the k-th contact of each of its four discs, a disc with fewer
/// contacts is paired with itself at zero stiffness.
struct ContactSlots {
  LaneVector<std::int32_t> first;      ///< groups + 1
  LaneVector<std::int32_t> neighbour;  ///< slots x lanes: place of the other disc
  std::vector<std::int32_t> contact;   ///< slots x lanes: c + 1 for contact c, -(c + 1) if the disc is its j; 0: none
};

ContactSlots list_slots(const Assembly& assembly, const DiscLayout& layout);

}  // namespace equidem
