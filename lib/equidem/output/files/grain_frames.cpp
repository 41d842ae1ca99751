// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/grain_frames.hpp"

#include <algorithm>

#include "equidem/output/files/placed_discs.hpp"

namespace equidem {

Assembly discs_of_frames(std::span<const Grain> grains, std::span<const Clump> clumps, bool come_and_go,
                         FrameOptions& options) {
  const auto any = [&](GrainShape shape) {
    return std::ranges::any_of(grains, [&](const Grain& grain) { return grain.shape() == shape; });
  };
  Assembly start;
  options.parts.clear();
  for (std::size_t g = 0; g < grains.size(); ++g) {
    const Grain& grain = grains[g];
    const auto add = [&](Vec2 offset, double radius) {
      options.parts.push_back({g, offset});
      start.centres.push_back(grain.position + turned(offset, grain.angle));
      start.radii.push_back(radius);
    };
    if (grain.shape() != GrainShape::clump) {
      add({}, grain.radius);
    } else {
      for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs) add(disc.offset, disc.radius);
    }
  }
  if (any(GrainShape::ellipse)) {
    options.of_discs.push_back({"short_half_axis", start.radii});
    DiscNumbers& axes = options.of_discs.back();
    for (std::size_t k = 0; k < options.parts.size(); ++k)
      if (const Grain& grain = grains[options.parts[k].body]; grain.shape() == GrainShape::ellipse)
        axes.values[k] = grain.short_half_axis;
  }
  if (any(GrainShape::clump) || come_and_go) {
    options.of_discs.push_back({"body", {}});
    DiscNumbers& bodies = options.of_discs.back();
    for (const FramePart& part : options.parts) bodies.values.push_back(static_cast<double>(part.body));
  }
  options.travelling = true;
  return start;
}

}  // namespace equidem
