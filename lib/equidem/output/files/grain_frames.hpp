// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Colliding bodies as the discs of frames (frames.hpp).
#pragma once

#include <span>

#include "equidem/assembly/assembly.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/output/files/frames.hpp"

namespace equidem {

/// The discs of all bodies at the start: a clump is shown as its discs, each with place, velocity, angle and spin of
/// its own. Where there are clumps, or bodies come and go, the array `body` holds the number of the body; where there
/// are ellipses `radius` is their long half-axis, which lies along the angle, and `short_half_axis` the other, of discs
/// the radius.
/// \param come_and_go whether bodies do
/// \param options gets travelling, of_discs and parts
Assembly discs_of_frames(std::span<const Grain> grains, std::span<const Clump> clumps, bool come_and_go,
                         FrameOptions& options);

}  // namespace equidem
