// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Formatting of text; the only place that includes fmt.
#pragma once

#include <string>

#include <fmt/format.h>

namespace equidem {

/// "1 disc", "2 discs".
inline std::string counted(long long count, const std::string& singular, const std::string& plural = {}) {
  return fmt::format("{} {}", count, count == 1 ? singular : plural.empty() ? singular + "s" : plural);
}

/// A number of bytes as a person reads it: "5.7 GB".
std::string readable_bytes(double bytes);

}  // namespace equidem
