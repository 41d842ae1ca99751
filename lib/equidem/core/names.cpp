// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/names.hpp"

#include "equidem/core/error.hpp"
#include "equidem/core/nearest.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

std::string alternatives(std::span<const std::string> names) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (k > 0) text += k + 1 < names.size() ? ", " : " or ";
    text += fmt::format("\"{}\"", names[k]);
  }
  return text;
}

void refuse_name(std::string_view name, const char* what, std::span<const std::string> known) {
  const auto meant = nearest(name, known);
  bad_input(fmt::format("unknown {} '{}'", what, name), fmt::format("it must be {}", alternatives(known)),
            meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Choose one of them");
}

}  // namespace equidem
