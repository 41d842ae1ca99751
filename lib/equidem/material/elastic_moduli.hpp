// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Isotropic elastic moduli in two dimensions. The same sheet of discs has one shear modulus and one two-dimensional
/// bulk modulus, but its Poisson's ratio and Young's modulus depend on the reading, plane strain or plane stress.
#pragma once

#include <optional>

#include "equidem/core/names.hpp"

namespace equidem {

enum class Plane { strain, stress };

template <>
struct EnumNames<Plane> {
  static constexpr const char* what = "plane";
  static constexpr NamedValue<Plane> list[] = {{Plane::strain, "strain"}, {Plane::stress, "stress"}};
};

/// G and nu with the reading of nu.
struct ElasticModuli {
  double shear_modulus = 0;  ///< G, Pa, > 0
  double poisson_ratio = 0;  ///< in the reading `plane`: (-1, 1/2) for plane strain, (-1, 1) for plane stress
  Plane plane = Plane::strain;

  /// These moduli in the other reading: nu_strain = nu_stress / (1 + nu_stress); G does not change.
  [[nodiscard]] ElasticModuli read_as(Plane other) const;
  /// E = 2 G (1 + nu), Pa.
  [[nodiscard]] double young_modulus() const;
  /// K = G/(1 - 2 nu) in plane strain, Pa: sigma_mm / 2 = K eps_mm.
  [[nodiscard]] double bulk_modulus_2d() const;
  /// lambda = K - G, Pa.
  [[nodiscard]] double lame_lambda() const;
};

/// From E and nu of the given reading.
/// \throws Error (bad_input) out of range
ElasticModuli moduli_from_young(double young_modulus, double poisson_ratio, Plane plane);
/// From the two-dimensional bulk modulus and G: nu2 = (K - G)/(K + G).
/// \throws Error (bad_input) out of range
ElasticModuli moduli_from_bulk(double bulk_modulus_2d, double shear_modulus, Plane plane);
/// nu of the ratio G/K, at least -1: (1 - G/K)/2 in plane strain, (1 - G/K)/(1 + G/K) in plane stress.
double poisson_ratio_of(double shear_to_bulk, Plane plane);
/// \throws Error (bad_input) where a modulus is not positive and finite or nu is outside its range
void check(const ElasticModuli& moduli);

/// An isotropic elastic continuum, described by one of four sets: G and nu, E and nu, K and G, or the two wave speeds
/// and the density. A density beside the first three does not bear on the moduli.
struct ElasticMaterial {
  std::optional<double> shear_modulus;    ///< G, Pa
  std::optional<double> young_modulus;    ///< E, Pa
  std::optional<double> poisson_ratio;    ///< nu
  std::optional<double> bulk_modulus_2d;  ///< K, Pa
  std::optional<double> p_wave_speed;     ///< Vp, m/s
  std::optional<double> s_wave_speed;     ///< Vs, m/s
  std::optional<double> density;          ///< kg/m³, gamma: of the continuum, discs and voids together
  Plane plane = Plane::strain;            ///< reading of nu and E
};

/// By the wave speeds
///
///   G = gamma Vs²,   K = gamma (Vp² - Vs²),
///
/// since in plane strain lambda + 2G = K + G = gamma Vp² (Sukegawa 2010, section 2). Vp of a sheet in plane stress is
/// that of its plane waves, with the same relation.
/// \throws Error (bad_input), with the name of the member at fault as its place: none of the four sets, moduli out of
///         range, Vs not below Vp
ElasticModuli moduli_of(const ElasticMaterial& material);

}  // namespace equidem
