// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Checkpoint file of a run, from which it continues bit-identically.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/contact/frame.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/motion/saved_state.hpp"

namespace equidem {

/// The motions of all bodies at one time, for a moving picture.
struct FilmFrame {
  std::int64_t step = 0;
  double time = 0;                  ///< s
  std::vector<DiscMotion> motions;  ///< as AnySimulation::motions
  std::vector<Vec2> walls = {};     ///< places of the walls, in the order of RunPlan::walls; NaN: not there
};

/// History of a run from its start.
struct RunRecord {
  std::vector<EnergySample> energies;
  std::vector<std::vector<Vec2>> paths;  ///< positions of all bodies at each sample; empty: not recorded
  std::vector<FilmFrame> film;           ///< of some samples; empty: not recorded
  std::vector<SavedArray> recorded;      ///< of a RunRecorder
};

/// The part of a file that a checkpoint counts on. Entries behind it were written after the checkpoint, or only because
/// the run ended there; a run that goes on replaces them.
struct FileMark {
  std::string name;            ///< without folder and spaces
  std::uint64_t length = 0;    ///< bytes of a table, frames of an animation
  std::uint64_t checksum = 0;  ///< of that part
};

struct Checkpoint {
  SavedState state;
  RunRecord record = {};
  std::vector<FileMark> files = {};

  /// \throws Error (bad_input) where the checkpoint counts on no file of that name
  [[nodiscard]] const FileMark& mark_of(const std::string& name) const;
};

/// Writes NAME.checkpoint.h5: an HDF5 file after 512 bytes of text that name the format, the version of the library,
/// the length of the file and a checksum of all of it. Arrays: case (the text of the resolved case); step; those of the
/// saved state; energies: step, time and every term of the ledger, a row for each sample so far; paths; film; those of
/// the recorder; attribute "files": name, length and checksum of each file counted on. A checkpoint is written to a
/// temporary file, synced to disk, and then renamed, so that the last complete one survives a kill at any moment, a
/// power failure or a full disk.
class CheckpointWriter {
 public:
  /// \param case_text the resolved case, by which read_checkpoint identifies the run of a checkpoint
  /// \param overwrite replace a checkpoint of another run, or of this run when it continues
  /// \throws Error (bad_input) if the file exists and `overwrite` is false, or if it cannot be written
  CheckpointWriter(std::filesystem::path path, std::string case_text, bool overwrite);

  /// \throws Error (computation_failed) if the disk is full; the last checkpoint remains
  void write(const Checkpoint& checkpoint) const;

 private:
  std::filesystem::path path_;
  std::string case_text_;
};

/// \param case_text the resolved case to continue
/// \throws Error (bad_input) if the file does not exist, is not a checkpoint, is truncated or altered, was written by
///         another version of the format or the library, or belongs to another case (with the first lines that differ)
Checkpoint read_checkpoint(const std::filesystem::path& path, const std::string& case_text);

/// "line 7: 'kT = 1' there, 'kT = 2' here": where two texts of cases differ, up to three lines.
std::string first_differences(std::string_view there, std::string_view here);

/// The case that a checkpoint belongs to.
/// \throws Error (bad_input) as read_checkpoint, for the file alone
std::string case_of_checkpoint(const std::filesystem::path& path);

}  // namespace equidem
