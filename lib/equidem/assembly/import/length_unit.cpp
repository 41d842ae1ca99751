// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/import/length_unit.hpp"

#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

struct NamedUnit {
  std::string_view name;
  double metres;
};
constexpr NamedUnit lengths[] = {{"m", 1},     {"dm", 0.1},  {"cm", 0.01}, {"mm", 1e-3},
                                 {"um", 1e-6}, {"µm", 1e-6}, {"nm", 1e-9}, {"km", 1e3}};
constexpr NamedUnit lammps_units[] = {{"si", 1}, {"cgs", 0.01}, {"micro", 1e-6}, {"nano", 1e-9}};

}  // namespace

std::optional<double> length_unit(std::string_view text) {
  text = trimmed(text);
  const std::size_t end = text.find_first_not_of("0123456789.+-eE");
  const std::string_view number = trimmed(text.substr(0, end == std::string_view::npos ? text.size() : end));
  const std::string_view name = trimmed(text.substr(end == std::string_view::npos ? text.size() : end));
  const auto factor = number.empty() ? std::optional(1.0) : number_from<double>(number);
  if (!factor || !is_positive(*factor)) return {};
  for (const NamedUnit& unit : lengths)
    if (name == unit.name) return *factor * unit.metres;
  return {};
}

std::optional<double> lammps_length_unit(std::string_view units) {
  for (const NamedUnit& unit : lammps_units)
    if (units == unit.name) return unit.metres;
  return {};
}

}  // namespace equidem
