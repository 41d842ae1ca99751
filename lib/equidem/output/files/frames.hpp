// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The bodies of a run and the forces of their contacts over time: NAME.pvd, which ParaView opens as a series, and a
/// folder NAME of VTK XML files, which any VTK opens one by one.
/// Colliding bodies as the discs of frames (frames.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/checksum.hpp"
#include "equidem/core/file.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/output/files/checkpoint.hpp"

namespace equidem {

/// A constant number of every disc.
struct DiscNumbers {
  std::string name;  ///< of letters and '_'
  std::vector<double> values;
};

/// A disc of a body.
struct FramePart {
  std::size_t body = 0;
  Vec2 offset;  ///< in the frame of the body, m
};

struct FrameOptions {
  bool overwrite = false;  ///< files of that name
  /// Travelling bodies: points at their positions and an array `angle`, in place of points at the start with
  /// displacement and rotation.
  bool travelling = false;
  bool contacts = true;                        ///< write contacts
  bool moments = false;                        ///< with their bending moments
  std::optional<FileMark> continue_from = {};  ///< continue the files of an earlier run behind this mark
  std::vector<DiscNumbers> of_discs = {};      ///< beside the radius
  std::vector<FramePart> parts = {};           ///< of each disc; empty: every disc is a body
};

/// Bytes of a frame, about.
double bytes_of_frame(double discs, double contacts, const FrameOptions& options);

/// Writes frames, two files each, SI units, Float64:
///   NAME/discs_STEP.vtp     a point for each disc: radius, what FrameOptions::of_discs adds, velocity, spin and
///                           displacement, rotation, or angle
///   NAME/contacts_STEP.vtp  write_contacts (vtk.hpp): a line for each contact, with its force
/// The step has at least nine digits, and both files hold the time (PolyData::write). NAME.pvd lists the finished
/// frames with their times. Every file is written to a temporary file and then renamed: killed at any moment, all that
/// is listed is whole. Past 200 frames the list is written once in every 200th part of them, in sync() and in finish().
class FrameWriter {
 public:
  /// Removes the frames of an earlier run that are not continued.
  /// \param assembly must outlive the writer
  /// \throws Error (bad_input) where a file exists and neither `overwrite` nor `continue_from` is set, where it cannot
  ///         be written, or if the files to continue do not contain the frames of the mark: then no file is changed
  FrameWriter(const std::filesystem::path& folder, const std::string& name, const Assembly& assembly,
              const FrameOptions& options);

  /// Add a frame.
  /// \param step greater than last_step()
  /// \param time s
  /// \param motions, velocities per body, m and rad, m/s and rad/s; bodies that are not_there are left out
  /// \param contacts between those bodies, and with walls
  /// \param regular false: the frame is the last one, and a longer run has none at its step
  /// \throws Error (computation_failed) where the disk is full; earlier frames stay
  void append(std::int64_t step, double time, std::span<const DiscMotion> motions,
              std::span<const DiscMotion> velocities, std::span<const BodyContact> contacts, bool regular = true);
  /// List all frames and sync them to disk, as required before a checkpoint refers to them.
  void sync();
  /// List all frames in NAME.pvd.
  void finish() const { write_index(); }

  /// Name of the list, number and checksum of the frames without a last one that is not regular.
  [[nodiscard]] FileMark mark() const { return marked_; }
  [[nodiscard]] std::int64_t frames() const { return static_cast<std::int64_t>(steps_.size()); }
  /// Step of the last frame; -1: none.
  [[nodiscard]] std::int64_t last_step() const { return steps_.empty() ? -1 : steps_.back(); }

 private:
  [[nodiscard]] std::string file_name(std::string_view what, std::int64_t step) const;
  [[nodiscard]] std::vector<std::string> file_names(std::int64_t step) const;
  [[nodiscard]] std::vector<std::filesystem::path> other_files() const;
  void go_on(const FileMark& mark);
  void write(const std::string& name, const std::function<void(const TextSink&)>& make);
  void list_frame(std::int64_t step, const std::string& time);
  void write_index() const;

  std::filesystem::path folder_;
  std::string name_;
  const Assembly& assembly_;
  FrameOptions options_;
  std::vector<std::int64_t> steps_;
  Checksum sum_;                                 ///< of the discs, then of list and files of each frame
  FileMark marked_;                              ///< of the regular frames
  std::string index_;                            ///< of the finished frames, without head and tail
  std::vector<std::filesystem::path> unsynced_;  ///< written since the last sync()
};

/// The discs of all bodies at the start: a clump is shown as its discs, each with place, velocity, angle and spin of
/// its own. Where there are clumps, or bodies come and go, the array `body` holds the number of the body; where there
/// are ellipses `radius` is their long half-axis, which lies along the angle, and `short_half_axis` the other, of discs
/// the radius.
/// \param come_and_go whether bodies do
/// \param options gets travelling, of_discs and parts
Assembly discs_of_frames(std::span<const Grain> grains, std::span<const Clump> clumps, bool come_and_go,
                         FrameOptions& options);

}  // namespace equidem
