// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Lines of a text that another program wrote, with their numbers for messages.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace equidem {

/// Reads a text line by line:
///
///   TextLines lines(text);
///   while (lines.next()) use(lines.line());
class TextLines {
 public:
  /// \param text must outlive the object
  explicit TextLines(std::string_view text) : rest_(text) {}

  /// Whether there is another line, which the functions below are about.
  bool next();
  /// Whether the line ends in a line break: LAMMPS ends every line in one, so that the last line of a file without it
  /// was cut off.
  [[nodiscard]] bool is_whole() const { return is_whole_; }
  [[nodiscard]] std::string_view line() const { return line_; }  ///< trimmed
  [[nodiscard]] int number() const { return number_; }           ///< from 1
  /// Throw an Error (bad_input) at the line.
  [[noreturn]] void fail(std::string problem, std::string why, std::string remedy) const;

 private:
  std::string_view rest_, line_;
  int number_ = 0;
  bool is_whole_ = true;
};

/// A finite number. \throws Error (bad_input) at "line N", naming the column
double finite_number(std::string_view text, std::string_view column, int line);
/// A whole number. \throws Error as above
std::int64_t whole_number(std::string_view text, std::string_view column, int line);

}  // namespace equidem
