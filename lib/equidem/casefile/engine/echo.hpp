// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Documents as text again.
#pragma once

#include <filesystem>
#include <string>

#include "equidem/casefile/engine/toml.hpp"

namespace equidem {

/// \param document of a case, its paths as the program opens them
/// \param folder where the text will lie: paths are written relative to it
std::string to_toml(TomlValue document, const std::filesystem::path& folder);

}  // namespace equidem
