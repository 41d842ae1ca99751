// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/units.hpp"

#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

struct NamedUnit {
  std::string_view name;
  Quantity quantity;
  double factor;
};
// Of two micro signs, that of Latin-1 and the Greek letter, each is in use.
constexpr NamedUnit units[] = {{"m", Quantity::length, 1},          {"dm", Quantity::length, 0.1},
                               {"cm", Quantity::length, 0.01},      {"mm", Quantity::length, 1e-3},
                               {"um", Quantity::length, 1e-6},      {"\u00b5m", Quantity::length, 1e-6},
                               {"\u03bcm", Quantity::length, 1e-6}, {"nm", Quantity::length, 1e-9},
                               {"km", Quantity::length, 1e3},       {"s", Quantity::time, 1},
                               {"ms", Quantity::time, 1e-3},        {"us", Quantity::time, 1e-6},
                               {"\u00b5s", Quantity::time, 1e-6},   {"\u03bcs", Quantity::time, 1e-6},
                               {"min", Quantity::time, 60},         {"Hz", Quantity::frequency, 1},
                               {"kHz", Quantity::frequency, 1e3},   {"MHz", Quantity::frequency, 1e6},
                               {"%", Quantity::share, 0.01},        {"percent", Quantity::share, 0.01},
                               {"-", Quantity::share, 1},           {"1", Quantity::share, 1},
                               {"rad", Quantity::angle, 1},         {"m_per_s", Quantity::speed, 1},
                               {"m/s", Quantity::speed, 1},         {"mm_per_s", Quantity::speed, 1e-3},
                               {"mm/s", Quantity::speed, 1e-3},     {"rad_per_s", Quantity::spin, 1},
                               {"rad/s", Quantity::spin, 1},        {"kg_per_m3", Quantity::density, 1},
                               {"kg/m3", Quantity::density, 1},     {"kg/m\u00b3", Quantity::density, 1},
                               {"kg", Quantity::mass, 1},           {"kg_per_m", Quantity::mass, 1},
                               {"Pa", Quantity::stress, 1},         {"kPa", Quantity::stress, 1e3},
                               {"MPa", Quantity::stress, 1e6},      {"GPa", Quantity::stress, 1e9}};

}  // namespace

std::optional<double> unit_factor(std::string_view unit, std::optional<Quantity> quantity) {
  for (const NamedUnit& known : units)
    if (unit == known.name && (!quantity || *quantity == known.quantity)) return known.factor;
  return {};
}

std::string units_of(Quantity quantity) {
  std::vector<std::string> names;
  for (const NamedUnit& known : units)
    if (known.quantity == quantity && static_cast<unsigned char>(known.name.front()) < 0x80)
      names.emplace_back(known.name);
  return joined(names);
}

std::optional<double> length_unit(std::string_view text) {
  text = trimmed(text);
  const std::size_t end = std::min(text.find_first_not_of("0123456789.+-eE"), text.size());
  const std::string_view number = trimmed(text.substr(0, end));
  const auto factor = number.empty() ? std::optional(1.0) : number_from<double>(number);
  const auto metres = unit_factor(trimmed(text.substr(end)), Quantity::length);
  if (!factor || !is_positive(*factor) || !metres) return {};
  return *factor * *metres;
}

}  // namespace equidem
