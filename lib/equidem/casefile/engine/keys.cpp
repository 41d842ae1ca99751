// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/keys.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

bool Range::contains(double value) const {
  if (!std::isfinite(value) || (zero_excluded && value == 0)) return false;
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
  const auto shown = [](double value) {
    const bool short_whole = std::abs(value) < 1e7 && value == std::floor(value);
    return short_whole ? fmt::format("{:.0f}", value) : fmt::format("{:g}", value);
  };
  if (zero_excluded) return "not 0";
  if (low == -infinity && high == infinity) return {};
  if (high == infinity) return fmt::format("{} {}", low_open ? ">" : ">=", shown(low));
  if (low == -infinity) return fmt::format("{} {}", high_open ? "<" : "<=", shown(high));
  if (low_open && high_open) return fmt::format("between {} and {}", shown(low), shown(high));
  if (!low_open && !high_open) return fmt::format("from {} to {}", shown(low), shown(high));
  return fmt::format("{} {} and {} {}", low_open ? ">" : ">=", shown(low), high_open ? "<" : "<=", shown(high));
}

const TableSpec* FileSpec::table(std::string_view name) const {
  const auto found = std::ranges::find(tables, name, &TableSpec::name);
  return found == tables.end() ? nullptr : &*found;
}

const KeySpec* FileSpec::key(std::string_view table, std::string_view name) const {
  const auto found =
      std::ranges::find_if(keys, [&](const KeySpec& key) { return key.name == name && key.table == table; });
  return found == keys.end() ? nullptr : &*found;
}

}  // namespace equidem::casefile
