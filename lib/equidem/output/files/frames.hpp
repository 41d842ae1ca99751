// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The motion of an assembly over time: NAME.h5, and beside it NAME.xdmf2, the index that ParaView opens.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/checksum.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/hdf5.hpp"
#include "equidem/output/files/open_file.hpp"

namespace equidem {

/// A constant number of every disc: `discs/NAME` (n).
struct DiscNumbers {
  std::string name;  ///< of letters and '_'
  std::string unit;  ///< empty: none
  std::vector<double> values;
};

/// A disc of a body.
struct FramePart {
  std::size_t body = 0;
  Vec2 offset;  ///< in the frame of the body, m
};

struct FrameOptions {
  /// Frames to reserve space for, >= 1. If there are more, the file is copied into one of twice the size.
  std::int64_t expected = 100;
  bool overwrite = false;  ///< files of that name
  /// Travelling bodies: write positions and angles, as `position` and `angle`, in place of displacements and rotations;
  /// ParaView shows the points at their positions.
  bool travelling = false;
  std::optional<FileMark> continue_from = {};  ///< continue the files of an earlier run behind this mark
  std::vector<DiscNumbers> of_discs = {};      ///< beside the radius
  std::vector<FramePart> parts = {};           ///< of each disc; empty: every disc is a body
};

/// Writes frames. NAME.h5 (schema "equidem-frames/1"), n discs, m contacts, room for K frames, behind 512 bytes of text
/// that name the places of the arrays for a run that goes on (the HDF5 library may crash on a damaged file):
///   discs/centre (n, 2) and discs/radius (n), m; discs/number (n); what FrameOptions::of_discs adds; contacts/discs
///   (m, 2), contacts/shift (m, 2), contacts/lever (m, 2), m; period (2), m, where there is one; frames (1): how many
/// are finished; the arrays of the others are undefined, and their times are NaN; time (K), s; step (K); displacement
///   (K, n, 3), m; rotation (K, n), rad; velocity (K, n, 3), m/s; spin (K, n), rad/s; the third component of vectors is
/// zero, as ParaView requires 3-vectors. Killed at any moment the file opens and holds all finished frames. NAME.xdmf2
/// is replaced at once by one that lists the new frame too; past 200 frames that is done once in every 200th part of
/// them, and in finish().
class FrameWriter {
 public:
  /// \param assembly must outlive the writer
  /// \throws Error (bad_input) where a file exists and neither `overwrite` nor `continue_from` is set, where it cannot
  ///         be written, or if the file to continue does not contain the frames of the mark
  FrameWriter(const std::filesystem::path& folder, const std::string& name, const Assembly& assembly,
              const FrameOptions& options);

  /// Add a frame.
  /// \param step greater than last_step()
  /// \param time s
  /// \param motions, velocities per body; m and rad, m/s and rad/s
  /// \param regular false: the frame is the last one, and a longer run has none at its step
  /// \throws Error (computation_failed) where the disk is full; earlier frames stay
  void append(std::int64_t step, double time, std::span<const DiscMotion> motions,
              std::span<const DiscMotion> velocities, bool regular = true);
  /// Sync all frames to disk, as required before a checkpoint refers to them.
  void sync() { file_->sync(); }
  /// Release the space of unused frames, and list all frames in NAME.xdmf2.
  void finish();

  /// Name, number and checksum of the frames without a last one that is not regular.
  [[nodiscard]] FileMark mark() const { return marked_; }
  [[nodiscard]] std::int64_t frames() const { return static_cast<std::int64_t>(times_.size()); }
  /// Step of the last frame; -1: none.
  [[nodiscard]] std::int64_t last_step() const { return steps_.empty() ? -1 : steps_.back(); }

 private:
  void go_on(const FileMark& mark, std::int64_t expected);
  void resize(std::int64_t room);
  [[nodiscard]] Hdf5Layout layout_of(std::int64_t room) const;
  void write_static(OpenFile& file, const Hdf5Layout& layout) const;
  void write_field(const std::string& translation, const std::string& rotation, std::span<const DiscMotion> values);
  void list_frame(std::size_t frame);
  void write_index() const;

  std::filesystem::path path_, index_path_;
  const Assembly& assembly_;
  bool travelling_;
  std::vector<DiscNumbers> of_discs_;
  std::vector<FramePart> parts_;
  Hdf5Layout layout_;
  std::optional<OpenFile> file_;
  std::vector<double> times_;
  std::vector<std::int64_t> steps_;
  Checksum sum_;       ///< of the discs, then of step, time and numbers of each frame
  FileMark marked_;    ///< of the regular frames
  std::string index_;  ///< of the finished frames, without head and tail
};

}  // namespace equidem
