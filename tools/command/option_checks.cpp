// SPDX-License-Identifier: GPL-3.0-or-later
#include "option_checks.hpp"

#include <cmath>
#include <optional>
#include <string_view>

#include "equidem/core/text.hpp"

namespace equidem {

PointsInNumbers::PointsInNumbers() : numbers_(newlocale(LC_NUMERIC_MASK, "C", nullptr)), before_(uselocale(numbers_)) {}

PointsInNumbers::~PointsInNumbers() {
  uselocale(before_);
  if (numbers_ != nullptr) freelocale(numbers_);
}

OptionCheck whole_number(std::int64_t least, std::int64_t most) {
  return [=](const std::string& given) {
    const auto value = number_given<std::int64_t>(given);
    return value && *value >= least && *value <= most
               ? ""
               : fmt::format("'{}' is not a whole number from {} to {}", given, least, most);
  };
}

OptionCheck finite_number() {
  return [](const std::string& given) {
    const auto value = number_given<double>(given);
    return value && std::isfinite(*value) ? "" : fmt::format("'{}' is not a finite number", given);
  };
}

OptionCheck number(double least, double most) {
  return [=](const std::string& given) {
    const auto value = number_given<double>(given);
    return value && *value >= least && *value <= most
               ? ""
               : fmt::format("'{}' is not a number from {:g} to {:g}", given, least, most);
  };
}

OptionCheck plain_text() {
  return [](const std::string& given) { return has_controls(given) ? std::string("it has control characters") : ""; };
}

OptionCheck file_name() {
  return [](const std::string& given) {
    if (given.empty()) return std::string("the name is empty");
    return given.starts_with("--") ? fmt::format("'{0}' is an option; a file of that name is ./{0}", given) : "";
  };
}

}  // namespace equidem
