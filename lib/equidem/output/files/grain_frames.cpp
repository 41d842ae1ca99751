// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/grain_frames.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "equidem/output/files/placed_discs.hpp"

namespace equidem {
namespace {

bool any(std::span<const Grain> grains, GrainShape shape) {
  return std::ranges::any_of(grains, [&](const Grain& grain) { return grain.shape() == shape; });
}

}  // namespace

GrainFrames::GrainFrames(const std::filesystem::path& folder, const std::string& name, std::span<const Grain> grains,
                         std::span<const Clump> clumps, FrameOptions options) {
  for (std::size_t g = 0; g < grains.size(); ++g) {
    const Grain& grain = grains[g];
    const auto add = [&](Vec2 offset, double radius) {
      parts_.push_back({g, offset});
      start_.centres.push_back(grain.position + turned(offset, grain.angle));
      start_.radii.push_back(radius);
    };
    if (grain.shape() != GrainShape::clump) {
      add({}, grain.radius);
    } else {
      for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs) add(disc.offset, disc.radius);
    }
  }
  if (any(grains, GrainShape::ellipse)) {
    DiscNumbers& axes = options.of_discs.emplace_back("short_half_axis", "m", start_.radii);
    for (std::size_t k = 0; k < parts_.size(); ++k)
      if (grains[parts_[k].grain].shape() == GrainShape::ellipse)
        axes.values[k] = grains[parts_[k].grain].short_half_axis;
  }
  if (any(grains, GrainShape::clump)) {
    DiscNumbers& bodies = options.of_discs.emplace_back("body", "", std::vector<double>());
    for (const Part& part : parts_) bodies.values.push_back(static_cast<double>(part.grain));
  }
  options.travelling = true;
  writer_.emplace(folder, name, start_, options);
}

void GrainFrames::append(std::int64_t step, double time, std::span<const Grain> grains) {
  std::vector<DiscMotion> motions, velocities;
  motions.reserve(parts_.size());
  velocities.reserve(parts_.size());
  for (const Part& part : parts_) {
    const Grain& grain = grains[part.grain];
    const bool in_the_middle = part.offset == Vec2{};
    const Vec2 arm = in_the_middle ? Vec2{} : turned(part.offset, grain.angle);
    motions.push_back({grain.position + arm, grain.angle});
    velocities.push_back({grain.velocity + grain.spin * perpendicular(arm), grain.spin});
  }
  writer_->append(step, time, motions, velocities);
}

}  // namespace equidem
