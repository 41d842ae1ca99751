// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables that a user or another program wrote: the one reader of them.
#pragma once

#include <charconv>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace equidem {

/// The number that a text is as a whole; none where it is no number.
template <class Number>
std::optional<Number> number_from(std::string_view text) {
  Number number{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

/// What a unit measures.
enum class Dimension { length, time, frequency, share, angle, speed, spin, density, mass, stress };

/// Value of a unit in SI: 1e-3 of "mm", 0.01 of "%"; none where it is no unit of the quantity, or of any.
std::optional<double> unit_factor(std::string_view unit, std::optional<Dimension> quantity = {});

/// "m, dm, cm, mm, um, nm, km": the units of a quantity, for messages.
std::string units_of(Dimension quantity);

/// Metres of a unit of length, or of a length such as "2.5 mm"; none where it is no length.
std::optional<double> length_unit(std::string_view text);

/// Takes a row of a table off the text, without its line break: LF, CRLF or CR; within quotes a line break is text.
struct TableRecord {
  std::string_view text;
  int lines = 1;            ///< that it takes
  bool is_closed = true;    ///< whether all its quotes end
  bool has_quotes = false;  ///< whether there are any
};
TableRecord take_record(std::string_view& rest);

/// The cells of a row, trimmed, without their quotes (RFC 4180); valid until the next row.
class TableCells {
 public:
  /// \param separator ',', ';', '\t' or ' ': blanks
  void split(const TableRecord& record, char separator);
  [[nodiscard]] const std::vector<std::string_view>& all() const { return cells_; }

 private:
  std::string_view unquoted(std::string_view& rest);

  std::vector<std::string_view> cells_;
  std::deque<std::string> kept_;  ///< cells with doubled quotes
};

/// A name of a column: "X [mm]" is x in mm.
struct ColumnName {
  std::string text;  ///< as it is written
  std::string name;  ///< in lower case, without the unit
  std::string unit;  ///< "mm" of "x_mm", "x [mm]" and "x (mm)"; may be empty
};

/// Reads a table row by row. Rows that are blank or begin with '#' are passed over. Commas, semicolons, tabs or blanks
/// separate the cells of all rows, as in the first one; cells may be quoted, and numbers may have a decimal comma where
/// the comma separates nothing. The first row names the columns, or a comment before the rows of numbers that holds the
/// names needed:
///
///   TableFile file(path, {{"x"}, {"radius", "r"}});
///   const std::size_t x = file.need({"x"}, "every disc has a place");
///   while (file.next()) use(file.number(x));
class TableFile {
 public:
  /// Columns that are needed, each by one of several names.
  using Names = std::vector<std::vector<std::string>>;
  /// The names of the columns that a comment stands for, such as "#format x_y_z_r", with blanks between them; none: it
  /// is a plain one. Rows may have more cells. Throws by the function given.
  using OfComment = std::function<std::optional<std::string>(const TableFile&, std::string_view)>;

  /// \throws Error (bad_input) as read_file; a text of UTF-16
  TableFile(const std::filesystem::path& path, Names needed);
  /// \param text must outlive the object
  /// \param name of the file for messages; empty: messages give lines alone
  TableFile(std::string_view text, std::string name, Names needed, const OfComment& of_comment = {});
  ~TableFile() = default;
  TableFile(const TableFile&) = delete;  // cells refer to the content
  TableFile& operator=(const TableFile&) = delete;

  /// Empty where the table names none.
  [[nodiscard]] const std::vector<ColumnName>& names() const { return names_; }
  /// Whether a comment named the format (OfComment).
  [[nodiscard]] bool names_by_format() const { return names_by_format_; }
  /// Cells of every row; 0 where there is none.
  [[nodiscard]] std::size_t width() const { return width_; }
  /// The place of the column that has one of the names; none where there is none.
  /// \throws Error (bad_input) where there are two
  [[nodiscard]] std::optional<std::size_t> find(const std::vector<std::string>& names) const;
  /// find, or an Error (bad_input) that names the nearest column.
  [[nodiscard]] std::size_t need(const std::vector<std::string>& names, const std::string& why) const;
  /// What numbers of a column are multiplied by to be in SI; none where its name has no unit.
  /// \throws Error (bad_input) where it is no unit of the quantity
  [[nodiscard]] std::optional<double> factor(std::size_t column, std::optional<Dimension> quantity) const;

  /// Whether there is another row, which the functions below are about.
  /// \throws Error (bad_input) where it has not as many cells as the first
  bool next();
  [[nodiscard]] const std::vector<std::string_view>& cells() const { return cells_.all(); }
  /// A finite number. \throws Error (bad_input) at the row
  /// \param name of what it is; empty: that of the column
  [[nodiscard]] double number(std::size_t column, std::string_view name = {}) const;
  /// A whole number. \throws Error (bad_input) at the row
  [[nodiscard]] std::int64_t whole(std::size_t column, std::string_view name = {}) const;

  [[nodiscard]] int line() const { return line_; }   ///< from 1
  [[nodiscard]] std::string where() const;           ///< "grains.csv:3"
  [[nodiscard]] std::string where_of_names() const;  ///< likewise
  /// Throw an Error (bad_input) at the row, or at the names.
  [[noreturn]] void fail(std::string problem, std::string why, std::string remedy) const;
  [[noreturn]] void fail_at_names(std::string problem, std::string why, std::string remedy) const;
  /// Refuses rows of a table without names where commas separate cells and seem to stand in numbers.
  void refuse_decimal_commas() const;

 private:
  void begin(const OfComment& of_comment);
  bool take_row(const OfComment& of_comment);
  void take_comment(std::string_view comment, const OfComment& of_comment);
  void take_names(std::vector<ColumnName> names);
  [[nodiscard]] std::string place(int line) const;
  void check_text(std::string_view text) const;

  std::string name_, content_;
  Names needed_;
  std::string_view rest_;
  TableCells cells_;
  std::vector<ColumnName> names_;
  std::unordered_map<std::string, std::size_t> places_;    ///< of names
  std::unordered_map<std::string, std::size_t> repeated_;  ///< names that are there again, the second place
  std::size_t width_ = 0;
  char separator_ = 0;
  bool row_at_hand_ = false, names_by_format_ = false;
  int line_ = 1, next_line_ = 1, line_of_names_ = 1;
  mutable char decimal_sign_ = 0;  ///< of the first number that has one
  mutable int line_of_decimal_sign_ = 0;
};

}  // namespace equidem
