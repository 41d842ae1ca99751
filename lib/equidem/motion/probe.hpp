// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Probes: the motion of chosen bodies over time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

/// Bonded discs have displacements and rotations, colliding bodies positions and angles; both velocities and spins.
enum class ProbeQuantity { displacement, rotation, position, angle, velocity, spin };

struct ProbeQuantityFacts {
  ProbeQuantity value;
  const char* name;
  bool rate;
  const char *column, *second_column;  ///< ends of their names; an angle has one
};
template <>
struct EnumNames<ProbeQuantity> {
  static constexpr const char* what = "quantity of a probe";
  static constexpr ProbeQuantityFacts list[] = {
      {ProbeQuantity::displacement, "displacement", false, "_ux_m", "_uy_m"},
      {ProbeQuantity::rotation, "rotation", false, "_rotation_rad", nullptr},
      {ProbeQuantity::position, "position", false, "_x_m", "_y_m"},
      {ProbeQuantity::angle, "angle", false, "_angle_rad", nullptr},
      {ProbeQuantity::velocity, "velocity", true, "_vx_m_per_s", "_vy_m_per_s"},
      {ProbeQuantity::spin, "spin", true, "_spin_rad_per_s", nullptr}};
};

/// The mean over some bodies.
struct Probe {
  std::string name;                  ///< begins the names of its columns
  std::vector<std::int32_t> bodies;  ///< numbers from 0; empty: those of `group`
  std::vector<ProbeQuantity> quantities = {ProbeQuantity::displacement};
  std::string group = {};
  std::optional<Rectangle> box = {};      ///< m; the bodies with their centre inside are counted too
  std::optional<double> wavelength = {};  ///< m, of a standing wave whose period the mean velocity has
};

}  // namespace equidem
