// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/value.hpp"

#include "equidem/casefile/engine/read_value.hpp"

namespace equidem::casefile {

double number_of(const TomlValue& value) {
  if (value.type == TomlValue::Type::boolean) return 0;
  return bytes_of(value).value_or(0);
}

std::filesystem::path path_of(TomlValue& value, const std::filesystem::path& folder) {
  const std::filesystem::path path = opened(value.text, folder);
  value.text = path.string();
  value.is_path = true;
  return path;
}

}  // namespace equidem::casefile
