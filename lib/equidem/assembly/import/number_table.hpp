// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables of numbers with commas, semicolons or spaces between the cells, and names of columns, if any.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/assembly/import/text_lines.hpp"

namespace equidem {

/// A name of a column, in lower case, without its unit.
struct ColumnName {
  std::string name;
  std::string unit;  ///< "mm" of "x_mm", "x [mm]" and "x (mm)"; may be empty
};

class NumberTable {
 public:
  /// Reads up to the first row of numbers.
  /// \param text must outlive the object
  /// \throws Error (bad_input) where there is no row, a format of YADE is not known, or names are repeated
  explicit NumberTable(std::string_view text);

  /// Empty where the table names none.
  [[nodiscard]] const std::vector<ColumnName>& names() const { return names_; }
  /// Whether YADE wrote it: "#format".
  [[nodiscard]] bool by_yade() const { return by_yade_; }
  [[nodiscard]] std::size_t width() const { return cells_.size(); }
  [[nodiscard]] int line_of_names() const { return line_of_names_; }
  /// The place of the first of several names of a column; none where there is none.
  [[nodiscard]] std::optional<std::size_t> find(const std::vector<std::string>& names) const;
  /// find, or an Error (bad_input) that names the nearest column.
  [[nodiscard]] std::size_t need(const std::vector<std::string>& names, const std::string& why) const;

  /// The row at hand; the first one is there from the start.
  [[nodiscard]] const std::vector<std::string_view>& cells() const { return cells_; }
  [[nodiscard]] int line() const { return lines_.number(); }
  /// Whether there is another row.
  /// \throws Error (bad_input) where it has not as many cells as the first
  bool next();

 private:
  void split(std::string_view line);
  void take_names(const std::vector<std::string_view>& words, int line);
  void take_comment(std::string_view comment);

  TextLines lines_;
  std::vector<ColumnName> names_, commented_;
  std::vector<std::string_view> cells_;
  char separator_ = ' ';
  bool by_yade_ = false;
  int line_of_names_ = 1, line_of_comment_ = 1;
};

}  // namespace equidem
