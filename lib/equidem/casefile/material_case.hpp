// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [material]: the continuum that the springs shall stand for.
#pragma once

#include <optional>

#include "equidem/casefile/toml.hpp"
#include "equidem/material/elastic_moduli.hpp"

namespace equidem {

struct MaterialCase {
  ElasticModuli moduli;
  std::optional<double> density;  ///< kg/m³, gamma: of the continuum, discs and voids together
  bool static_only = false;       ///< kT < 0 allowed
};

/// From G and nu, E and nu, K and G, or the wave speeds and the density gamma:
///
///   G = gamma Vs²,   K = gamma (Vp² - Vs²),
///
/// since in plane strain lambda + 2G = K + G = gamma Vp² (Sukegawa 2010, section 2). Vp of a sheet in plane stress is
/// that of its plane waves, with the same relation.
/// \param table checked by check_and_complete
/// \throws Error (bad_input), with its line: keys that are none of the four sets, moduli out of range, Vs not below Vp
MaterialCase read_material(const TomlValue& table);

}  // namespace equidem
