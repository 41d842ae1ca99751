// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/xml.hpp"

namespace equidem {

std::string escape_xml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return escaped;
}

}  // namespace equidem
