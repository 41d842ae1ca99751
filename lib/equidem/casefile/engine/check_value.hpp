// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Whether one value is what its key wants.
#pragma once

#include <string>

#include "equidem/casefile/engine/keys.hpp"

namespace equidem::casefile {

/// "a number in Pa, > 0", `one of "square", "hexagonal"`: what a key wants.
std::string expected(const KeySpec& key);

/// \throws Error (bad_input), where = "file:line: table.key": wrong type, out of range, not finite, no choice
void check_value(const TomlValue& value, const KeySpec& key);

}  // namespace equidem::casefile
