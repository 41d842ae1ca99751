// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Names that reading and writing an assembly file share.
#pragma once

#include <string>

namespace equidem {

inline constexpr const char* assembly_schema = "equidem-assembly/1";

/// A text (UTF-8) as JSON has it, between quotation marks.
std::string quoted_json(const std::string& text);

}  // namespace equidem
