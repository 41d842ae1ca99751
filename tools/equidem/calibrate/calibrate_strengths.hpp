// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem calibrate with [strength_target]: wanted strengths -> strengths and friction of the contacts.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"

namespace equidem {

/// Carries out the verb, and returns the exit code.
/// \param file to which the strengths found are written; none: strength.toml in --out
/// \throws Error (bad_input) where [material] stands beside [strength_target]; as calibrate_strength
int calibrate_strengths(const CommonOptions& options, const std::optional<std::filesystem::path>& file, Case read);

/// Writes what was found into its file, or into the report where none is named.
/// \param noun "springs", "strength"
void add_found_file(Results& results, std::vector<OutputPart>& parts, const std::string& noun,
                    const std::optional<std::filesystem::path>& path, const std::string& text);
/// Says that no file is written, in the report and in the JSON.
void add_no_file(Results& results, const std::string& noun, const std::string& why);
/// What was asked for, moduli or strengths, is out of reach: `refusal`, and its line.
Results refusal_results(const Error& refusal);

}  // namespace equidem
