// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/wave_speed_springs.hpp"

#include <cmath>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "equidem/core/error.hpp"
#include "equidem/material/inertia.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

nlohmann::json reference() {
  std::ifstream file(std::string(EQUIDEM_SOURCE_DIR) + "/data/reference/soil_material.json");
  return nlohmann::json::parse(file);
}

constexpr double density = 2480, damping = 1;

}  // namespace

TEST_CASE("soil_springs_are_those_of_an_independent_computation") {
  const auto expected = reference()["springs"];
  const WaveSpeeds speeds = wave_speeds_from_shear(150, 0.25);
  const SpringConstants springs = springs_of_wave_speeds(density, speeds);
  CHECK(speeds.pressure == Approx(expected["Vp"].get<double>()).epsilon(1e-14));
  CHECK(springs.kN == Approx(expected["kn_per_m"].get<double>()).epsilon(1e-14));
  CHECK(springs.kT == Approx(expected["ks_per_m"].get<double>()).epsilon(1e-14));
  CHECK(springs.ratio() == Approx(expected["ks_over_kn"].get<double>()).epsilon(1e-14));
}

TEST_CASE("wave_speeds_of_moduli_are_those_of_poissons_ratio") {
  const double nu = GENERATE(-0.5, 0.0, 0.25, 0.45);
  CAPTURE(nu);
  const WaveSpeeds from_moduli = wave_speeds_of({.shear_modulus = 55.8e6, .poisson_ratio = nu}, density);
  const WaveSpeeds from_ratio = wave_speeds_from_shear(150, nu);
  CHECK(from_moduli.shear == Approx(from_ratio.shear).epsilon(1e-14));
  CHECK(from_moduli.pressure == Approx(from_ratio.pressure).epsilon(1e-13));
}

TEST_CASE("soil_discs_vibrate_and_are_damped_as_an_independent_computation_says") {
  const auto all = reference();
  const SpringConstants springs = springs_of_wave_speeds(density, wave_speeds_from_shear(150, 0.25));
  const std::string radius = GENERATE("0.005", "0.00625", "0.0075", "0.01");
  CAPTURE(radius);
  const auto expected = all["disc_r_" + radius];
  const auto number = [&](const char* key) { return Approx(expected[key].get<double>()).epsilon(1e-12); };
  const double r = std::stod(radius);
  const Inertia inertia = inertia_of(r, density, Body::disc);
  const double m = inertia.mass;
  CHECK(m == number("m_per_m"));
  CHECK(inertia.moment == number("I_per_m"));
  CHECK(dashpot_of(damping, m, springs.kN) == number("cn_h1"));
  CHECK(dashpot_of(damping, m, springs.kT) == number("cs_h1"));
  // Two discs: the reduced mass is half of one.
  const double frequency = std::sqrt(springs.kN / (m / 2));
  const double zeta = dashpot_of(damping, m, springs.kN) / (2 * std::sqrt(m / 2 * springs.kN));
  CHECK(frequency == number("pair_omega"));
  CHECK(zeta == number("pair_zeta_h1"));
  CHECK(semi_implicit_limit(zeta) / frequency == number("dt_crit_pair_semi_implicit"));
  // The fastest wave of the hexagonal lattice with kT = kN/3 is uniform spin, omega² = 24 kT/m.
  CHECK(2 / std::sqrt(24 * springs.kT / m) == number("dt_crit_hex_undamped"));
}

TEST_CASE("wave_speed_springs_refuse_what_is_no_material") {
  CHECK_THROWS_AS(springs_of_wave_speeds(-1, {150, 260}), Error);
  CHECK_THROWS_AS(wave_speeds_from_shear(150, 0.5), Error);
  CHECK_THROWS_AS(dashpot_of(-0.1, 1, 1), Error);
}
