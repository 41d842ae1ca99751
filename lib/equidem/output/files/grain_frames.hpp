// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The motion of colliding bodies over time, as frames (frames.hpp) whose discs travel.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/output/files/frames.hpp"

namespace equidem {

/// A clump is shown as its discs, each with place, velocity, angle and spin of its own. Where there are clumps
/// `discs/body` tells the number of the body; where there are ellipses `discs/radius` is their long half-axis, which
/// lies along the angle, and `discs/short_half_axis` the other, of discs the radius.
class GrainFrames {
 public:
  /// \param options expected, overwrite, continue_after
  /// \throws Error (bad_input) as FrameWriter
  GrainFrames(const std::filesystem::path& folder, const std::string& name, std::span<const Grain> grains,
              std::span<const Clump> clumps, FrameOptions options);
  GrainFrames(const GrainFrames&) = delete;
  GrainFrames& operator=(const GrainFrames&) = delete;

  /// \param grains those of the start, where they are now
  /// \throws Error (computation_failed) where the disk is full; earlier frames stay
  void append(std::int64_t step, double time, std::span<const Grain> grains);
  void sync() { writer_->sync(); }
  void finish() { writer_->finish(); }
  [[nodiscard]] std::int64_t last_step() const { return writer_->last_step(); }

 private:
  struct Part {
    std::size_t grain = 0;
    Vec2 offset;  ///< of the disc of a clump, in the frame of its body, m
  };

  std::vector<Part> parts_;  ///< discs, as frames count them
  Assembly start_;
  std::optional<FrameWriter> writer_;
};

}  // namespace equidem
