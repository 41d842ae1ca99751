// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Every reader of files that users write or that the programs read back, with valid files of its kind.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace equidem::fuzz {

struct Reader {
  std::string name;
  std::vector<std::string> seeds;  ///< valid inputs
  /// \throws Error where the input is refused; std::logic_error where what was accepted does not read back
  std::function<void(const std::string& input)> read;
};

/// \param source folder of the repository
/// \param scratch folder for the files that are read
std::vector<Reader> make_readers(const std::filesystem::path& source, const std::filesystem::path& scratch);

}  // namespace equidem::fuzz
