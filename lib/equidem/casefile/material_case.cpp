// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/material_case.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "equidem/casefile/read_value.hpp"

namespace equidem {
namespace {

using Words = std::vector<std::string>;

/// What fixes two moduli; a density beside the first three is that of the continuum and says nothing of its moduli.
const std::vector<Words> sets = {{"shear_modulus", "poisson_ratio"},
                                 {"young_modulus", "poisson_ratio"},
                                 {"bulk_modulus_2d", "shear_modulus"},
                                 {"p_wave_speed", "s_wave_speed", "density"}};

std::string listed(const Words& words) {
  std::string list;
  for (std::size_t k = 0; k < words.size(); ++k)
    list += (k == 0 ? "" : k + 1 == words.size() ? " and " : ", ") + words[k];
  return list;
}

bool contains(const Words& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

Words without(Words words, const Words& others) {
  words.erase(std::remove_if(words.begin(), words.end(), [&](const auto& word) { return contains(others, word); }),
              words.end());
  return words;
}

/// The keys of the table that say something about moduli.
Words given_in(const TomlValue& table) {
  Words given;
  for (const auto& [name, value] : table.entries) {
    const bool counts =
        std::any_of(sets.begin(), sets.end(), [&, &key = name](const Words& set) { return contains(set, key); });
    if (counts && name != "density") given.push_back(name);
  }
  if (table.find("density") != nullptr && (contains(given, "p_wave_speed") || contains(given, "s_wave_speed")))
    given.emplace_back("density");
  return given;
}

[[noreturn]] void fail_set(const TomlValue& table, const Words& given) {
  std::string remedy = "Give ";
  for (const Words& set : sets) remedy += (&set == &sets.front() ? "" : ", or ") + listed(set);
  if (given.empty())
    fail_at(table, "material", "the moduli are missing", "two of them describe an isotropic continuum", remedy);
  const auto distance = [&](const Words& set) { return without(set, given).size() + without(given, set).size(); };
  const Words& meant = *std::min_element(sets.begin(), sets.end(),
                                         [&](const Words& a, const Words& b) { return distance(a) < distance(b); });
  const Words missing = without(meant, given), surplus = without(given, meant);
  std::string why =
      missing.empty() ? "" : fmt::format("{} {} missing", listed(missing), missing.size() == 1 ? "is" : "are");
  if (!surplus.empty())
    why +=
        fmt::format("{}{} {} too much", why.empty() ? "" : ", ", listed(surplus), surplus.size() == 1 ? "is" : "are");
  const TomlValue& at = surplus.empty() ? table : *table.find(surplus.front());
  fail_at(
      at, surplus.empty() ? "material" : "material." + surplus.front(),
      fmt::format("{} {} not describe an isotropic continuum", listed(given), given.size() == 1 ? "alone does" : "do"),
      why, remedy);
}

ElasticModuli moduli_from_waves(const TomlValue& table, Plane plane) {
  const double p = number(table, "p_wave_speed");
  const double s = number(table, "s_wave_speed");
  const double density = number(table, "density");
  if (s >= p) {
    fail_at(*table.find("s_wave_speed"), "material.s_wave_speed",
            fmt::format("s_wave_speed = {} is not below p_wave_speed = {}", s, p),
            "K = density (Vp² - Vs²) must be positive for the body to be stable", "Correct the speeds");
  }
  return moduli_from_bulk(density * (p - s) * (p + s), density * s * s, plane);
}

}  // namespace

MaterialCase read_material(const TomlValue& table) {
  const Words given = given_in(table);
  const auto same = [&](const Words& set) { return without(set, given).empty() && without(given, set).empty(); };
  const auto set = std::find_if(sets.begin(), sets.end(), same);
  if (set == sets.end()) fail_set(table, given);
  MaterialCase result;
  const Plane plane = enum_from<Plane>(text(table, "plane"));
  try {
    switch (set - sets.begin()) {
      case 0:
        result.moduli = {number(table, "shear_modulus"), number(table, "poisson_ratio"), plane};
        break;
      case 1:
        result.moduli = moduli_from_young(number(table, "young_modulus"), number(table, "poisson_ratio"), plane);
        break;
      case 2:
        result.moduli = moduli_from_bulk(number(table, "bulk_modulus_2d"), number(table, "shear_modulus"), plane);
        break;
      default:
        result.moduli = moduli_from_waves(table, plane);
        break;
    }
    check(result.moduli);
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: material", table.where()));
  }
  if (const TomlValue* density = table.find("density")) result.density = density->real;
  result.static_only = flag(table, "static_only");
  return result;
}

}  // namespace equidem
