// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pictures side by side on one page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace equidem {

struct SheetPicture {
  std::filesystem::path file;  ///< PNG
  std::string label = {};      ///< above it; may be empty
};

/// Write a PNG with the pictures in rows, each 450 pixels wide; a row is as high as its highest picture.
/// \param columns >= 1
/// \throws Error (bad_input) without pictures, on files that are no PNG, and as write_file does
void write_picture_sheet(const std::filesystem::path& file, const std::string& title,
                         const std::vector<SheetPicture>& pictures, std::size_t columns, bool overwrite);

}  // namespace equidem
