// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/table_file.hpp"

#include <algorithm>
#include <string_view>

namespace equidem::casefile {

std::string comment_lines(const std::string& text) {
  std::string out;
  for (std::string_view rest = text; !rest.empty();) {
    std::string line(rest.substr(0, rest.find('\n')));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    for (char& c : line)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    out += line.empty() ? "#\n" : fmt::format("# {}\n", line);
  }
  return out;
}

}  // namespace equidem::casefile
