// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Isotropic elastic moduli in two dimensions. The same sheet of discs has one shear modulus and one two-dimensional
/// bulk modulus, but its Poisson's ratio and Young's modulus depend on the reading, plane strain or plane stress.
#pragma once

#include <string>

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
/// \throws Error (bad_input) where a modulus is not positive and finite or nu is outside its range
void check(const ElasticModuli& moduli);

}  // namespace equidem
