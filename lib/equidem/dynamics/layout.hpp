// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How discs and their contacts lie in memory while they are stepped in time.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

/// Discs in an order of strips along x, so thick that contacts join a strip only to itself and the next ones, and
/// within strips in groups of four whose lanes are computed at once. Places without a disc fill a strip up.
///
/// Strips let several steps be made while data are near: strip l can be at step k + 1 as soon as its neighbours are at
/// step k. Where the assembly repeats along y a strip holds discs of its lower and of its upper half: the ring lies
/// flat.
struct DiscLayout {
  static constexpr int lanes = 4;

  std::vector<std::int32_t> disc_at;      ///< place -> disc, -1: none; places x lanes
  std::vector<std::int32_t> place_of;     ///< disc -> place
  std::vector<std::int32_t> strip_first;  ///< strips + 1, in groups

  [[nodiscard]] std::int32_t groups() const { return static_cast<std::int32_t>(disc_at.size() / lanes); }
  [[nodiscard]] std::int32_t strips() const { return static_cast<std::int32_t>(strip_first.size()) - 1; }
};

DiscLayout lay_out(const Assembly& assembly);

/// The contacts of every group: slot k of a group holds the k-th contact of each of its four discs, a disc that has
/// fewer being paired with itself at no stiffness.
struct ContactSlots {
  LaneVector<std::int32_t> first;      ///< groups + 1
  LaneVector<std::int32_t> neighbour;  ///< slots x lanes: place of the other disc
  std::vector<std::int32_t>
      contact;  ///< slots x lanes: contact c as c + 1, as -(c + 1) where the disc is its j; 0: none
};

ContactSlots list_slots(const Assembly& assembly, const DiscLayout& layout);

}  // namespace equidem
