// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A table as CSV that grows while a run goes on, and is gone on with where the run is.
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
  double interval = 5;     ///< s of the clock on the wall between two writes; 64 KiB of rows are written at once
  bool overwrite = false;  ///< a file of that name
  /// Go on with the file of an earlier run: rows later than this step, and a row cut short, are dropped.
  std::optional<std::int64_t> continue_after = {};
};

/// Rows whose first cell is the step.
class GrowingCsv {
 public:
  /// \param columns the first is the step
  /// \throws Error (bad_input) where the file exists and neither `overwrite` nor `continue_after` is set, where it
  ///         cannot be written,
  ///         or where the file to go on with has other columns
  GrowingCsv(std::filesystem::path path, std::vector<std::string> columns, const GrowingCsvOptions& options);
  /// Writes what is left; errors are lost: flush() before.
  ~GrowingCsv();
  GrowingCsv(const GrowingCsv&) = delete;
  GrowingCsv& operator=(const GrowingCsv&) = delete;

  /// Add a row.
  /// \param step greater than last_step()
  /// \param cells of the other columns
  /// \throws Error (computation_failed) where the disk is full
  void add(std::int64_t step, const std::vector<double>& cells);
  /// Hand all rows to the operating system.
  void flush();
  /// Return once all rows are on the disk, as they must be before a checkpoint counts on them.
  void sync();

  /// Of the last row; -1: none.
  [[nodiscard]] std::int64_t last_step() const { return last_step_; }

 private:
  void go_on(std::int64_t after);

  std::filesystem::path path_;
  double interval_;
  std::vector<std::string> columns_;
  std::string header_;
  CsvText rows_;  ///< the header, and rows that are not yet written
  std::optional<OpenFile> file_;
  std::uint64_t end_ = 0;  ///< of what is written
  std::int64_t last_step_ = -1;
  Stopwatch since_flush_;
};

}  // namespace equidem
