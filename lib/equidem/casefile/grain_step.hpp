// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// From the case to what is simulated: the step, the scene, the options.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "equidem/casefile/grain_case.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// The step of a run beside the shortest of its contacts.
struct GrainStep {
  double step = 0;  ///< s
  double contact =
      0;  ///< s, the shortest contact; 0: unknown (hertz_dashpot without closing_speed), or no two bodies can meet
  std::string between;  ///< its kinds, "grains and walls"
  /// omega dt of it, omega = sqrt(k/m), the root of a; hertz_dashpot: by the tangent stiffness at the largest overlap;
  /// 0: unknown.
  double omega_step = 0;
  /// Largest omega dt at which the scheme is stable for one contact: 2 (sqrt(1 + zeta²) - zeta) of the laws with a
  /// dashpot, zeta over the critical one there; 1 of the maps (past it a contact is over in a step); 0: none.
  double limit = 0;
  double bond_limit = 0;  ///< s, of bonds; 0: none
  bool automatic = false;

  [[nodiscard]] double steps_in_contact() const { return contact / step; }
};

/// \throws Error (bad_input) with line and key where an automatic step cannot be known: dimensionless_stiffness,
///         hertz_dashpot without
///         closing_speed, no two bodies that can meet; where linear_dashpot or hertz_dashpot is unstable even for one
///         contact
GrainStep choose_grain_step(const GrainCase& resolved);

/// Steps of the whole duration.
/// \throws Error (bad_input) where they are too many to be counted
std::int64_t count_steps(const GrainCase& resolved, double step);

GrainScene build_grain_scene(const GrainCase& resolved, double step);
GrainOptions grain_options(const GrainCase& resolved, double step);

}  // namespace equidem
