// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/elastic_material.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

using Words = std::vector<std::string>;

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

Words without(Words words, const Words& others) {
  std::erase_if(words, [&](const auto& word) { return std::ranges::find(others, word) != others.end(); });
  return words;
}

/// The members with a value that bear on the moduli.
Words given_in(const ElasticMaterial& m) {
  Words given;
  const auto add = [&](const std::optional<double>& value, const char* name) {
    if (value) given.emplace_back(name);
  };
  add(m.shear_modulus, "shear_modulus");
  add(m.young_modulus, "young_modulus");
  add(m.poisson_ratio, "poisson_ratio");
  add(m.bulk_modulus_2d, "bulk_modulus_2d");
  add(m.p_wave_speed, "p_wave_speed");
  add(m.s_wave_speed, "s_wave_speed");
  if (m.p_wave_speed || m.s_wave_speed) add(m.density, "density");
  return given;
}

[[noreturn]] void fail_set(const Words& given) {
  std::string remedy = "Give ";
  for (const Words& set : sets) remedy += (&set == &sets.front() ? "" : ", or ") + listed(set);
  if (given.empty()) bad_input("the moduli are missing", "two of them describe an isotropic continuum", remedy);
  const auto distance = [&](const Words& set) { return without(set, given).size() + without(given, set).size(); };
  const Words& meant = *std::ranges::min_element(sets, {}, distance);
  const Words missing = without(meant, given), surplus = without(given, meant);
  std::string why =
      missing.empty() ? "" : fmt::format("{} {} missing", listed(missing), missing.size() == 1 ? "is" : "are");
  if (!surplus.empty())
    why +=
        fmt::format("{}{} {} too much", why.empty() ? "" : ", ", listed(surplus), surplus.size() == 1 ? "is" : "are");
  throw Error(
      ErrorKind::bad_input,
      fmt::format("{} {} not describe an isotropic continuum", listed(given), given.size() == 1 ? "alone does" : "do"),
      why, remedy, surplus.empty() ? "" : surplus.front());
}

ElasticModuli moduli_from_waves(double p, double s, double density, Plane plane) {
  if (s >= p)
    throw Error(ErrorKind::bad_input, fmt::format("s_wave_speed = {} is not below p_wave_speed = {}", s, p),
                "K = density (Vp² - Vs²) must be positive for the body to be stable", "Correct the speeds",
                "s_wave_speed");
  return moduli_from_bulk(density * (p - s) * (p + s), density * s * s, plane);
}

}  // namespace

ElasticModuli moduli_of(const ElasticMaterial& m) {
  const Words given = given_in(m);
  const auto same = [&](const Words& set) { return without(set, given).empty() && without(given, set).empty(); };
  if (std::ranges::none_of(sets, same)) fail_set(given);
  const ElasticModuli moduli = m.p_wave_speed ? moduli_from_waves(*m.p_wave_speed, *m.s_wave_speed, *m.density, m.plane)
                               : m.bulk_modulus_2d ? moduli_from_bulk(*m.bulk_modulus_2d, *m.shear_modulus, m.plane)
                               : m.young_modulus   ? moduli_from_young(*m.young_modulus, *m.poisson_ratio, m.plane)
                                                   : ElasticModuli{*m.shear_modulus, *m.poisson_ratio, m.plane};
  check(moduli);
  return moduli;
}

}  // namespace equidem
