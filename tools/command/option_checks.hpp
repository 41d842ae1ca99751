// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Checks of the values of options, for CLI::Option::check.
#pragma once

#include <clocale>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "equidem/core/table_file.hpp"

namespace equidem {

/// While it lives, numbers of options have a decimal point in this thread, whatever locale the process is in: CLI11
/// reads them by strtold.
class PointsInNumbers {
 public:
  PointsInNumbers();
  ~PointsInNumbers();
  PointsInNumbers(const PointsInNumbers&) = delete;
  PointsInNumbers& operator=(const PointsInNumbers&) = delete;

 private:
  locale_t numbers_, before_;
};

/// The number that the value of an option is; none where it is none.
template <class Number>
std::optional<Number> number_given(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return number_from<Number>(text);
}

/// Returns what is wrong with a value, or nothing.
using OptionCheck = std::function<std::string(const std::string& given)>;

/// A whole number in [least, most].
OptionCheck whole_number(std::int64_t least, std::int64_t most = std::numeric_limits<std::int64_t>::max());
/// A finite number, or one in [least, most].
OptionCheck finite_number();
OptionCheck number(double least, double most);
/// A text without control characters.
OptionCheck plain_text();
/// The name of a file or folder: not empty, and no option that stands where a name was forgotten.
OptionCheck file_name();

}  // namespace equidem
