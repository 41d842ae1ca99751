// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/text.hpp"

namespace equidem {

std::string readable_bytes(double bytes) {
  const char* units[] = {"B", "kB", "MB", "GB", "TB"};
  int unit = 0;
  // The bounds are those of the rounded number: never "1000 kB" or "10.0 kB".
  while (bytes >= 999.5 && unit < 4) {
    bytes /= 1000;
    ++unit;
  }
  return fmt::format("{:.{}f} {}", bytes, bytes < 9.95 && unit > 0 ? 1 : 0, units[unit]);
}

}  // namespace equidem
