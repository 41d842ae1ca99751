// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbers of the arrays of a .vtp file, and the frames that a .pvd file lists.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "equidem/core/file.hpp"

namespace equidem {

/// Every array as doubles, by name; its appended block must have the length that it states.
inline std::map<std::string, std::vector<double>> arrays_of(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  const std::size_t data = text.find('_', text.find("encoding=\"raw\">")) + 1;
  const std::regex declared("<DataArray type=\"(\\w+)\" Name=\"(\\w+)\"[^>]* offset=\"(\\d+)\"");
  std::map<std::string, std::vector<double>> arrays;
  for (std::sregex_iterator at(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(data), declared), end;
       at != end; ++at) {
    const char* place = text.data() + data + std::stoul((*at)[3]);
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, place, sizeof bytes);
    const bool whole = (*at)[1] == "Int32";
    std::vector<double>& numbers = arrays[(*at)[2]];
    for (std::uint64_t k = 0; k < bytes; k += whole ? 4 : 8) {
      double number = 0;
      std::int32_t integer = 0;
      if (whole) std::memcpy(&integer, place + 8 + k, sizeof integer);
      if (!whole) std::memcpy(&number, place + 8 + k, sizeof number);
      numbers.push_back(whole ? integer : number);
    }
  }
  return arrays;
}

/// A frame of a list.
struct ListedFrame {
  std::int64_t step = 0;
  double time = 0;
  std::filesystem::path discs;
  std::filesystem::path contacts;  ///< empty: not written
};
inline std::vector<ListedFrame> frames_of(const std::filesystem::path& list) {
  const std::string text = read_file(list);
  const std::regex entry("timestep=\"([^\"]+)\" part=\"(\\d)\" name=\"\\w+\" file=\"([^\"]+_(\\d+)\\.vtp)\"");
  std::vector<ListedFrame> frames;
  for (std::sregex_iterator at(text.begin(), text.end(), entry), end; at != end; ++at) {
    const std::filesystem::path path = list.parent_path() / (*at)[3].str();
    if ((*at)[2] == "0") {
      frames.push_back({std::stoll((*at)[4]), std::stod((*at)[1]), path, {}});
    } else {
      frames.back().contacts = path;
    }
  }
  return frames;
}

}  // namespace equidem
