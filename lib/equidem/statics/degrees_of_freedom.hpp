// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The unknowns of statics: u_x, u_y and, where rotation is an effect of the scene, a*theta of every disc, less what
/// is held.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/statics/supports.hpp"

namespace equidem {

/// Which components of the motion of each disc are unknown. Held components keep their place in blocks, so that
/// blocks stay whole: their rows are those of a unit matrix (elimination without renumbering).
struct DegreesOfFreedom {
  int per_disc = 2;           ///< 2: (u_x, u_y); 3: (u_x, u_y, a theta)
  double rotation_scale = 1;  ///< a, m: the mean radius
  /// Why a component is no unknown: `supported`, its motion is prescribed; `inert`, no contact resists it.
  static constexpr std::uint8_t free = 0, supported = 1, inert = 2;
  std::vector<std::uint8_t> held;  ///< per component (disc * per_disc + k): one of the above
  std::vector<double> prescribed;  ///< m, per component: the value where held, else 0
  std::int64_t unknowns = 0;
  std::int64_t free_rotations = 0;   ///< unknowns that are rotations
  std::int64_t inert_rotations = 0;  ///< rotations that no contact resists: held at 0, they cannot change the answer
};

/// \throws Error (bad_input) where a support names no group or an empty one, prescribes a component twice with
///         different values, or prescribes a rotation that is not an unknown of the scene
DegreesOfFreedom number_unknowns(const Assembly& assembly, const ContactSprings& springs, const Effects& effects,
                                 std::span<const Support> supports);

/// Components (u_x, u_y[, a theta]) of all discs as their motions.
std::vector<DiscMotion> disc_motions(const DegreesOfFreedom& unknowns, std::span<const double> components);

}  // namespace equidem
