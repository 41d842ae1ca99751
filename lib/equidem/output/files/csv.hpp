// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables as comma-separated values (RFC 4180): one header line, units in the names of columns (x_m, stress_xx_Pa),
/// numbers in the shortest form that reads back to the same bits.
/// A CSV table that grows during a run and is continued when the run is resumed.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "equidem/core/checksum.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/files/open_file.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/output/files/checkpoint.hpp"

namespace equidem {

/// The text of a table, row by row. Every row must have as many cells as there are columns.
class CsvText {
 public:
  explicit CsvText(const std::vector<std::string>& columns);

  void cell(double value);  ///< "nan", "inf" and "-inf" where not finite
  void cell(std::integral auto value) { cell_of(static_cast<std::int64_t>(value)); }
  void cell(std::string_view value);  ///< quoted where it holds a comma, a quote or a line break
  template <class Value>
  void cell(const std::optional<Value>& value) {
    value ? cell(*value) : empty_cell();
  }
  void empty_cell() { separate(); }
  void end_row();
  /// Passes on what has come together, where it is a block, or all.
  void pass_on(const TextSink& to, bool all) { pass_block(text_, to, all ? 0 : std::size_t{1} << 16); }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void separate();
  void cell_of(std::int64_t value);

  std::string text_;
  std::size_t columns_;
  std::size_t cells_ = 0;  ///< in the current row
};

/// Named columns of equal length, for results of any kind: bodies, contacts, a study, a curve.
class Table {
 public:
  /// Cells of an empty optional are empty.
  using Values = std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>,
                              std::vector<std::optional<double>>, std::vector<std::optional<std::int64_t>>>;
  struct Column {
    std::string name;
    std::function<void(CsvText&, std::size_t row)> cell;
  };

  /// Add a column to the right of the others.
  /// \throws Error (bad_input) where the name is empty or taken or the length differs
  Table& add(std::string name, Values values);
  /// Add a column of the projection of each element of a range, a member or a function of the element.
  template <std::ranges::input_range Range, class Projection>
  Table& add(std::string name, const Range& range, const Projection& projection) {
    using Cell =
        std::remove_cvref_t<std::invoke_result_t<const Projection&, std::ranges::range_reference_t<const Range>>>;
    using Stored = std::conditional_t<std::integral<Cell>, std::int64_t, Cell>;
    std::vector<Stored> cells;
    for (const auto& element : range) cells.push_back(static_cast<Stored>(std::invoke(projection, element)));
    return add(std::move(name), Values(std::move(cells)));
  }
  /// The same without a copy: the range and what the projection refers to outlive the table.
  template <std::ranges::random_access_range Range, class Projection>
  Table& view(std::string name, const Range& range, const Projection& projection) {
    const auto cell = [&range, projection](CsvText& text, std::size_t k) {
      text.cell(std::invoke(projection, range[k]));
    };
    return add(std::move(name), std::ranges::size(range), cell);
  }

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  void write(const TextSink& to) const;
  [[nodiscard]] std::string csv() const;

 private:
  Table& add(std::string name, std::size_t rows, std::function<void(CsvText&, std::size_t row)> cell);

  std::vector<Column> columns_;
  std::size_t rows_ = 0;
};

/// \throws Error (bad_input) as write_file does
void write_csv(const std::filesystem::path& path, const Table& table, bool overwrite);

/// Cells of a CSV text (RFC 4180), row by row.
std::vector<std::vector<std::string>> csv_cells(const std::string& text);

/// The number of a whole cell; NaN where it is empty, nothing where it is no number.
std::optional<double> csv_number(const std::string& cell);
/// The integer of a whole cell; nothing where it is none.
std::optional<std::int64_t> csv_integer(const std::string& cell);

/// Write a table of samples that a later computation can continue: with a last column "checksum" of each row and of the
/// names of the columns.
/// \throws Error (bad_input) as write_file does
void write_samples(const std::filesystem::path& path, Table table);

/// Says how a last row that was cut short is read.
enum class CutRow { refused, left_out };

/// The rows of a table of write_samples that an earlier computation wrote and that this one continues.
class StoredTable {
 public:
  /// \param like has the columns that are expected, without the checksum; without columns: any are accepted
  /// \param of what the samples are of: "sweep", "study"
  /// \param remedy of every error
  /// \param rows what one row is, several of them: "samples", "events"
  /// \throws Error (bad_input) where the columns are others, or a row was altered since it was written
  StoredTable(std::filesystem::path path, const Table& like, const std::string& of, std::string remedy,
              std::string rows = "samples", CutRow cut = CutRow::refused);

  [[nodiscard]] std::size_t rows() const { return cells_.size() - 1; }
  [[nodiscard]] bool cut() const { return cut_; }  ///< whether a last row was left out
  [[nodiscard]] const std::vector<std::string>& columns() const { return cells_.front(); }  ///< and the checksum
  [[nodiscard]] const std::string& text(std::size_t row, std::size_t column) const { return cells_[row + 1][column]; }
  /// NaN where the cell is empty.
  /// \throws Error (bad_input) where it is no number
  [[nodiscard]] double number(std::size_t row, std::size_t column) const;
  /// \throws Error (bad_input) where the cell is no integer from `least` to `most`
  [[nodiscard]] std::int64_t integer(std::size_t row, std::size_t column, std::int64_t least = INT64_MIN,
                                     std::int64_t most = INT64_MAX) const;
  /// \throws Error (bad_input) always
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  std::filesystem::path path_;
  std::string remedy_, rows_;
  bool cut_ = false;
  std::vector<std::vector<std::string>> cells_;
};

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
  CsvText rows_;  ///< that are not yet written
  std::optional<OpenFile> file_;
  std::uint64_t end_ = 0;     ///< end of the written data
  std::uint64_t marked_ = 0;  ///< end of the regular rows, written or not
  Checksum sum_;              ///< of the text before `marked_`
  std::int64_t last_step_ = -1;
  Stopwatch since_flush_;
};

}  // namespace equidem
