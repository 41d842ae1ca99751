// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Conversion of documents to TOML text.
#pragma once

#include <filesystem>
#include <string>

#include "equidem/casefile/engine/toml.hpp"

namespace equidem {

/// \param document of a case, its paths as the program opens them
/// \param folder of the new file: paths are written relative to it
std::string to_toml(TomlValue document, const std::filesystem::path& folder);

}  // namespace equidem
