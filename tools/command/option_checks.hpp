// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Checks of the values of options, for CLI::Option::check.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>

namespace equidem {

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
