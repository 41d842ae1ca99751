// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Histories of a run for callers who keep results in memory.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "equidem/material/inertia.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/output/files/checkpoint.hpp"

#include "command.hpp"

namespace equidem {

/// The folder that the loop of a run writes its tables into: that of --out, or a temporary one.
class HistoryFolder {
 public:
  /// \param temporary whether tables are wanted where there is no --out
  HistoryFolder(const std::optional<std::filesystem::path>& out, bool temporary);
  ~HistoryFolder();
  HistoryFolder(const HistoryFolder&) = delete;
  HistoryFolder& operator=(const HistoryFolder&) = delete;

  [[nodiscard]] const std::optional<std::filesystem::path>& path() const { return path_; }
  [[nodiscard]] bool is_temporary() const { return temporary_; }
  /// The text of history.csv; empty: none was written.
  [[nodiscard]] std::string history() const;
  /// history/COLUMN and measures_history/COLUMN of the tables that were written, energies/COLUMN of the samples.
  [[nodiscard]] std::vector<ResultArray> arrays(const std::vector<EnergySample>& energies, BodyFamily family,
                                                Body body) const;

 private:
  std::optional<std::filesystem::path> path_;
  bool temporary_ = false;
};

}  // namespace equidem
