// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Reading and writing whole files, with errors a user can act on.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace equidem {

/// \throws Error (bad_input) where the file does not exist, is a folder, or cannot be read
std::string read_file(const std::filesystem::path& path);

/// Write a file whole or not at all: into a temporary file beside it, then renamed. Missing folders are made. Devices,
/// pipes and links are written into.
/// \throws Error (bad_input) where it exists and `overwrite` is false, or where it cannot be written (with the
///         reason)
void write_file(const std::filesystem::path& path, std::string_view content, bool overwrite);

/// Fail early: the error that write_file would give, without writing.
void check_writable(const std::filesystem::path& path, bool overwrite);

}  // namespace equidem
