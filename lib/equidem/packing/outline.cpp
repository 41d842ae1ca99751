// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/outline.hpp"

#include <numbers>

namespace equidem {

Outline outline_of(const Grain& grain, std::span<const Clump> clumps) {
  const Vec2 axis = axis_of_turns(grain.angle / (2 * std::numbers::pi));
  switch (grain.shape()) {
    case GrainShape::clump:
      return {.axis = axis, .discs = clumps[static_cast<std::size_t>(grain.clump)].discs};
    case GrainShape::ellipse:
      return {.a = grain.radius, .b = grain.short_half_axis, .axis = axis};
    case GrainShape::disc:
      break;
  }
  return {.a = grain.radius, .b = grain.radius};
}

}  // namespace equidem
