// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Probes: the motion of chosen bodies over time.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

/// Bonded discs have displacements and rotations, colliding bodies positions and angles, and the stress of the box of
/// the probe; both velocities and spins.
enum class ProbeQuantity { displacement, rotation, position, angle, velocity, spin, stress };

struct ProbeQuantityFacts {
  ProbeQuantity value;
  const char* name;
  bool rate;
  std::array<const char*, 4> columns;  ///< ends of their names; null: no more of them
};
template <>
struct EnumNames<ProbeQuantity> {
  static constexpr const char* what = "quantity of a probe";
  static constexpr ProbeQuantityFacts list[] = {
      {ProbeQuantity::displacement, "displacement", false, {"_ux_m", "_uy_m"}},
      {ProbeQuantity::rotation, "rotation", false, {"_rotation_rad"}},
      {ProbeQuantity::position, "position", false, {"_x_m", "_y_m"}},
      {ProbeQuantity::angle, "angle", false, {"_angle_rad"}},
      {ProbeQuantity::velocity, "velocity", true, {"_vx_m_per_s", "_vy_m_per_s"}},
      {ProbeQuantity::spin, "spin", true, {"_spin_rad_per_s"}},
      {ProbeQuantity::stress, "stress", false, {"_stress_xx_Pa", "_stress_xy_Pa", "_stress_yx_Pa", "_stress_yy_Pa"}}};
};

/// The mean over some bodies.
struct Probe {
  std::string name;                  ///< begins the names of its columns
  std::vector<std::int32_t> bodies;  ///< numbers from 0; empty: those of `group`
  std::vector<ProbeQuantity> quantities = {ProbeQuantity::displacement};
  std::string group = {};
  std::optional<Rectangle> box = {};      ///< m; the bodies with their centre inside are counted too; a stress is its
  std::optional<double> wavelength = {};  ///< m, of a standing wave whose period the mean velocity has
};

inline bool has_stress(const Probe& probe) {
  return std::ranges::find(probe.quantities, ProbeQuantity::stress) != probe.quantities.end();
}

}  // namespace equidem
