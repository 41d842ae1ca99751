// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/springs_file.hpp"

#include <sstream>

#include "equidem/casefile/assembly/case_tables.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

std::string springs_file(const SpringConstants& springs, SpringWeighting weighting, const std::string& title,
                         const std::string& comment) {
  std::string out;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) {
    // TOML allows no control characters in a comment.
    for (char& c : line)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    out += line.empty() ? "#\n" : fmt::format("# {}\n", line);
  }
  return out + fmt::format("schema = \"{}\"\ntitle = {}\n\n[springs]\nkN = {}\nkT = {}\nweighting = {}\n",
                           casefile::springs_file_format().spec().schema, toml_text(title), toml_number(springs.kN),
                           toml_number(springs.kT), toml_text(to_string(weighting)));
}

}  // namespace equidem
