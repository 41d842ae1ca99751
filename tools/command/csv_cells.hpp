// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables that the program wrote, read back.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace equidem {

/// Cells of a CSV text (RFC 4180), row by row.
std::vector<std::vector<std::string>> csv_cells(const std::string& text);

/// The number of a whole cell; NaN where it is empty, nothing where it is no number.
std::optional<double> csv_number(const std::string& cell);
/// The integer of a whole cell; nothing where it is none.
std::optional<std::int64_t> csv_integer(const std::string& cell);

}  // namespace equidem
