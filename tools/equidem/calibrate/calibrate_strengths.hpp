// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem calibrate with [strength_target]: wanted strengths -> strengths and friction of the contacts.
#pragma once

#include <filesystem>
#include <optional>

#include "command.hpp"

namespace equidem {

/// \param file of the strengths found; none: strength.toml in --out
int calibrate_strengths(const CommonOptions& options, const std::optional<std::filesystem::path>& file, Case read);

}  // namespace equidem
