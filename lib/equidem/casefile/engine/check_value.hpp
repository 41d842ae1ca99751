// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Check of a value against the description of its key.
#pragma once

#include <string>

#include "equidem/casefile/engine/keys.hpp"

namespace equidem::casefile {

/// "a number in Pa, > 0", `one of "square", "hexagonal"`: the values that a key accepts.
std::string expected(const KeySpec& key);

/// \throws Error (bad_input), where = "file:line: table.key": wrong type, out of range, not finite, no choice
void check_value(const TomlValue& value, const KeySpec& key);

}  // namespace equidem::casefile
