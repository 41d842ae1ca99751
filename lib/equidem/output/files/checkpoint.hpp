// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run in the middle, as a file from which it goes on with the same bits.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "equidem/motion/ledger.hpp"
#include "equidem/motion/saved_state.hpp"

namespace equidem {

/// History of a run from its start.
struct RunRecord {
  std::vector<EnergySample> energies;
  std::vector<std::vector<Vec2>> paths;  ///< places of all bodies at each sample; empty: not recorded
};

/// Writes NAME.checkpoint.h5: an HDF5 file after 512 bytes of text that name the format, the version of the library,
/// the length of the file and a checksum of all of it. Arrays: case (the text of the resolved case); step; those of the
/// saved state; energies: step, time and every term of the ledger, a row for each sample so far; paths. A checkpoint is
/// written beside the last one, forced to the disk, and takes its name then: killed at any moment, power cut or disk
/// full, the last good one is there.
class CheckpointWriter {
 public:
  /// \param case_text the resolved case, by which read_checkpoint knows that a checkpoint belongs to a run
  /// \param overwrite a checkpoint of another run, or of this one where it goes on
  /// \throws Error (bad_input) where the file exists and `overwrite` is false, or where it cannot be written
  CheckpointWriter(std::filesystem::path path, std::string case_text, bool overwrite);

  /// \throws Error (computation_failed) where the disk is full; the last checkpoint stays
  void write(const SavedState& state, const RunRecord& record = {}) const;

 private:
  std::filesystem::path path_;
  std::string case_text_;
};

struct Checkpoint {
  SavedState state;
  RunRecord record;
};

/// \param case_text the resolved case that is to go on
/// \throws Error (bad_input) where there is no such file, it is no checkpoint, it is truncated or altered, another
///         version of the format or the library wrote it, or it belongs to another case (with the first lines that
///         differ)
Checkpoint read_checkpoint(const std::filesystem::path& path, const std::string& case_text);

/// The case that a checkpoint belongs to.
/// \throws Error (bad_input) as read_checkpoint, for the file alone
std::string case_of_checkpoint(const std::filesystem::path& path);

}  // namespace equidem
