// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables of comma-separated cells that a user wrote.
#pragma once

#include <charconv>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
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

/// Reads a file row by row, without rows that are blank or begin with '#'; cells are trimmed and cannot be quoted:
///
///   TableFile file(path);
///   while (file.next()) use(file.cells());
class TableFile {
 public:
  /// \throws Error (bad_input) as read_file
  explicit TableFile(std::filesystem::path path);
  ~TableFile() = default;
  TableFile(const TableFile&) = delete;  // cells refer to the content
  TableFile& operator=(const TableFile&) = delete;

  /// Whether there is another row, which the functions below are about.
  bool next();
  [[nodiscard]] bool is_first() const { return count_ == 1; }
  [[nodiscard]] std::string_view row() const { return row_; }
  [[nodiscard]] const std::vector<std::string_view>& cells() const { return cells_; }  ///< at least one
  [[nodiscard]] int line() const { return line_; }                                     ///< from 1
  [[nodiscard]] std::string where() const;                                             ///< "grains.csv:3"
  /// Throw an Error (bad_input) at the row.
  [[noreturn]] void fail(std::string problem, std::string why, std::string remedy) const;

 private:
  std::filesystem::path path_;
  std::string content_;
  std::string_view rest_, row_;
  std::vector<std::string_view> cells_;
  int line_ = 0, count_ = 0;
};

}  // namespace equidem
