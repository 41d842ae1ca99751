// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A CSV table that grows during a run and is continued when the run is resumed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "equidem/core/stopwatch.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/open_file.hpp"

namespace equidem {

struct GrowingCsvOptions {
  double interval = 5;     ///< wall-clock seconds between two writes; 64 KiB of rows are written at once
  bool overwrite = false;  ///< a file of that name
  /// Continue the file of an earlier run: rows later than this step, and a row cut short, are dropped.
  std::optional<std::int64_t> continue_after = {};
};

/// Rows whose first cell is the step.
class GrowingCsv {
 public:
  /// \param columns the first is the step
  /// \throws Error (bad_input) where the file exists and neither `overwrite` nor `continue_after` is set, where it
  ///         cannot be written, or if the file to continue has other columns
  GrowingCsv(std::filesystem::path path, std::vector<std::string> columns, const GrowingCsvOptions& options);
  /// Writes the remaining rows and ignores errors; call flush() before.
  ~GrowingCsv();
  GrowingCsv(const GrowingCsv&) = delete;
  GrowingCsv& operator=(const GrowingCsv&) = delete;

  /// Add a row.
  /// \param step greater than last_step()
  /// \param cells of the other columns
  /// \throws Error (computation_failed) where the disk is full
  void add(std::int64_t step, const std::vector<double>& cells);
  /// Write all rows to the operating system.
  void flush();
  /// Sync all rows to disk, as required before a checkpoint refers to them.
  void sync();

  /// Step of the last row; -1: none.
  [[nodiscard]] std::int64_t last_step() const { return last_step_; }

 private:
  void go_on(std::int64_t after);

  std::filesystem::path path_;
  double interval_;
  std::vector<std::string> columns_;
  std::string header_;
  CsvText rows_;  ///< the header, and rows that are not yet written
  std::optional<OpenFile> file_;
  std::uint64_t end_ = 0;  ///< end of the written data
  std::int64_t last_step_ = -1;
  Stopwatch since_flush_;
};

}  // namespace equidem
