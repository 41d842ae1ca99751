// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Breaks of the bonds of colliding discs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/breakage/break_search.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// A bond that broke.
struct BondBreak {
  std::int64_t step = 0;  ///< steps done when it broke
  std::size_t bond = 0;   ///< in the order of the scene
  BreakMode mode = BreakMode::tension;
  Vec2 place = {};    ///< of the bond, m
  double energy = 0;  ///< of its springs, J (discs: per metre of depth)
};

/// The numbers of a break in a saved state.
inline constexpr auto break_numbers = [](auto& event, const auto& visit) {
  visit(event.step), visit(event.bond), visit(event.mode), visit(event.place.x), visit(event.place.y);
  visit(event.energy);
};

/// The bonds that have not broken, in their order.
std::vector<GrainBond> bonds_left(std::span<const GrainBond> bonds, std::span<const BondBreak> breaks);

}  // namespace equidem
