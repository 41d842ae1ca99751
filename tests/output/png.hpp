// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbers in the head of a PNG file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace equidem {

/// The big-endian integer of four bytes at `at`.
inline std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

}  // namespace equidem
