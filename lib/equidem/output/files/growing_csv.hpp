// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A CSV table that grows during a run and is continued when the run is resumed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "equidem/core/checksum.hpp"
#include "equidem/core/files/open_file.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {

struct GrowingCsvOptions {
  double interval = 5;     ///< wall-clock seconds between two writes; 64 KiB of rows are written at once
  bool overwrite = false;  ///< a file of that name
  std::optional<FileMark> continue_from = {};  ///< continue the file of an earlier run behind this mark
};

/// The part of a file that a checkpoint counts on.
/// \throws Error (bad_input) where the file is not there, has become shorter, or was altered
std::string read_marked(const std::filesystem::path& path, const FileMark& mark);

/// Rows whose first cell is the step.
class GrowingCsv {
 public:
  /// \param columns the first is the step
  /// \throws Error (bad_input) where the file exists and neither `overwrite` nor `continue_from` is set, where it
  ///         cannot be written, as read_marked, or if the file to continue has other columns
  GrowingCsv(std::filesystem::path path, std::vector<std::string> columns, const GrowingCsvOptions& options);
  /// Writes the remaining rows and ignores errors; call flush() before.
  ~GrowingCsv();
  GrowingCsv(const GrowingCsv&) = delete;
  GrowingCsv& operator=(const GrowingCsv&) = delete;

  /// Add a row.
  /// \param step greater than last_step()
  /// \param cells of the other columns
  /// \param regular false: the row is the last one, and a longer run has none at its step
  /// \throws Error (computation_failed) where the disk is full
  void add(std::int64_t step, const std::vector<double>& cells, bool regular = true);
  /// Write all rows to the operating system.
  void flush();
  /// Sync all rows to disk, as required before a checkpoint refers to them.
  void sync();
  /// Name, length and checksum of the table without a last row that is not regular.
  [[nodiscard]] FileMark mark() const;

  /// Step of the last row; -1: none.
  [[nodiscard]] std::int64_t last_step() const { return last_step_; }

 private:
  void go_on(const FileMark& mark);

  std::filesystem::path path_;
  double interval_;
  std::vector<std::string> columns_;
  std::string header_;
  CsvText rows_;  ///< the header, and rows that are not yet written
  std::optional<OpenFile> file_;
  std::uint64_t end_ = 0;     ///< end of the written data
  std::uint64_t marked_ = 0;  ///< end of the regular rows, written or not
  Checksum sum_;              ///< of the text before `marked_`
  std::int64_t last_step_ = -1;
  Stopwatch since_flush_;
};

}  // namespace equidem
