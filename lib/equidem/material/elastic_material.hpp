// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// An isotropic elastic continuum by any two numbers that describe it.
#pragma once

#include <optional>

#include "equidem/material/elastic_moduli.hpp"

namespace equidem {

/// One of four sets: G and nu, E and nu, K and G, or the two wave speeds and the density. A density beside the first
/// three does not bear on the moduli.
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
