// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/elastic_moduli.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Upper end of the range of nu, where the two-dimensional bulk modulus becomes infinite.
double incompressible_poisson_ratio(Plane plane) {
  return plane == Plane::strain ? 0.5 : 1.0;
}

void check_poisson_ratio(double nu, Plane plane) {
  const double limit = incompressible_poisson_ratio(plane);
  if (std::isfinite(nu) && nu > -1 && nu < limit) return;
  const bool other_reading = plane == Plane::strain && nu >= 0.5 && nu < 1;
  bad_input(fmt::format("Poisson's ratio is {:.6g} in plane {}", nu, to_string(plane)),
            fmt::format("it must lie between -1 and {}, both excluded, for the body to be stable", limit),
            other_reading ? "If it was measured on a thin sheet, set plane stress"
                          : fmt::format("Give a Poisson's ratio between -1 and {}", limit));
}

using Words = std::vector<std::string>;

const std::vector<Words> sets = {{"shear_modulus", "poisson_ratio"},
                                 {"young_modulus", "poisson_ratio"},
                                 {"bulk_modulus_2d", "shear_modulus"},
                                 {"p_wave_speed", "s_wave_speed", "density"}};

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
  const std::string remedy = "Give " + joined(
                                           sets, [](const Words& set) { return listed(set); }, ", or ");
  if (given.empty()) bad_input("the moduli are missing", "two of them describe an isotropic continuum", remedy);
  const auto distance = [&](const Words& set) { return without(set, given).size() + without(given, set).size(); };
  const Words& meant = *std::ranges::min_element(sets, {}, distance);
  const Words missing = without(meant, given), surplus = without(given, meant);
  Words why;
  const auto add = [&](const Words& names, const char* fault) {
    if (!names.empty()) why.push_back(fmt::format("{} {} {}", listed(names), names.size() == 1 ? "is" : "are", fault));
  };
  add(missing, "missing");
  add(surplus, "too much");
  bad_input_at(
      surplus.empty() ? "" : surplus.front(),
      fmt::format("{} {} not describe an isotropic continuum", listed(given), given.size() == 1 ? "alone does" : "do"),
      joined(why), remedy);
}

ElasticModuli moduli_from_waves(double p, double s, double density, Plane plane) {
  if (s >= p)
    bad_input_at("s_wave_speed", fmt::format("s_wave_speed = {} is not below p_wave_speed = {}", s, p),
                 "K = density (Vp² - Vs²) must be positive for the body to be stable", "Correct the speeds");
  return moduli_from_bulk(density * (p - s) * (p + s), density * s * s, plane);
}

}  // namespace

ElasticModuli ElasticModuli::read_as(Plane other) const {
  if (other == plane) return *this;
  const double nu = poisson_ratio;
  return {shear_modulus, other == Plane::strain ? nu / (1 + nu) : nu / (1 - nu), other};
}

double poisson_ratio_of(double shear_to_bulk, Plane plane) {
  const double q = shear_to_bulk;
  if (plane == Plane::strain) return std::max(-1.0, (1 - q) / 2);
  return std::isfinite(q) ? (1 - q) / (1 + q) : -1;
}

double ElasticModuli::young_modulus() const {
  return 2 * shear_modulus * (1 + poisson_ratio);
}

double ElasticModuli::bulk_modulus_2d() const {
  const double nu = poisson_ratio;
  return plane == Plane::strain ? shear_modulus / (1 - 2 * nu) : shear_modulus * (1 + nu) / (1 - nu);
}

double ElasticModuli::lame_lambda() const {
  const double nu = poisson_ratio;
  return shear_modulus * 2 * nu / (plane == Plane::strain ? 1 - 2 * nu : 1 - nu);
}

ElasticModuli moduli_from_young(double young_modulus, double poisson_ratio, Plane plane) {
  check_positive(young_modulus, "Young's modulus", "Pa");
  check_poisson_ratio(poisson_ratio, plane);
  return {young_modulus / (2 * (1 + poisson_ratio)), poisson_ratio, plane};
}

ElasticModuli moduli_from_bulk(double bulk_modulus_2d, double shear_modulus, Plane plane) {
  check_positive(bulk_modulus_2d, "two-dimensional bulk modulus", "Pa");
  check_positive(shear_modulus, "shear modulus", "Pa");
  const double K = bulk_modulus_2d;
  const double G = shear_modulus;
  // A sheet with G >= 3 K is stable, but as a section of a solid in plane strain it would have nu <= -1, that
  // is E <= 0.
  if (plane == Plane::strain && G >= 3 * K) {
    bad_input(fmt::format("a shear modulus of {:.6g} Pa with a two-dimensional bulk modulus of {:.6g} Pa has no "
                          "reading in plane strain",
                          G, K),
              fmt::format("Poisson's ratio would be {:.6g}, and no solid has one of -1 or less", (K - G) / (2 * K)),
              "Read it in plane stress");
  }
  return {G, plane == Plane::strain ? (K - G) / (2 * K) : (K - G) / (K + G), plane};
}

void check(const ElasticModuli& moduli) {
  check_positive(moduli.shear_modulus, "shear modulus", "Pa");
  check_poisson_ratio(moduli.poisson_ratio, moduli.plane);
}

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
