// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The unknowns of statics: u_x, u_y and, where rotation is an effect of the scene, a*theta of every disc, less the
/// components that are held.
#pragma once

#include <cstdint>
#include <vector>

namespace equidem {

/// Which components of the motion of each disc are unknown. Held components keep their place in blocks, so that
/// blocks stay whole: their rows are those of a unit matrix (elimination without renumbering).
struct DegreesOfFreedom {
  int per_disc = 2;           ///< 2: (u_x, u_y); 3: (u_x, u_y, a theta)
  double rotation_scale = 1;  ///< a, m: the mean radius
  /// Why a component is no unknown: `supported`, its motion is prescribed; `without_stiffness`, no contact resists it.
  static constexpr std::uint8_t free = 0, supported = 1, without_stiffness = 2;
  std::vector<std::uint8_t> held;  ///< per component (disc * per_disc + k): one of the above
  std::vector<double> prescribed;  ///< m, per component: the value where held, else 0
  std::int64_t unknowns = 0;
  std::int64_t free_rotations = 0;  ///< unknowns that are rotations
  std::int64_t rotations_without_stiffness =
      0;  ///< rotations that no contact resists: held at 0, without effect on the result
};

}  // namespace equidem
