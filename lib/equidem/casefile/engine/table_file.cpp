// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/table_file.hpp"

#include <sstream>

namespace equidem::casefile {

std::string comment_lines(const std::string& text) {
  std::string out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    for (char& c : line)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    out += line.empty() ? "#\n" : fmt::format("# {}\n", line);
  }
  return out;
}

}  // namespace equidem::casefile
