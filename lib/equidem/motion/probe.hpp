// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Probes: the motion of chosen bodies over time, and the period of a quantity that oscillates about zero.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
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

/// Counts the passages of a sampled quantity through zero, each interpolated between two samples; the error of the
/// period is of second order in the time between samples.
class Oscillation {
 public:
  /// Add a sample. \param time s, ascending
  void add(double time, double value);

  [[nodiscard]] std::int64_t passages() const { return passages_; }
  /// s, twice the mean time between passages; none before the second passage
  [[nodiscard]] std::optional<double> period() const;
  /// Largest difference of a time between two passages from their mean, over the mean; none before the second passage
  [[nodiscard]] std::optional<double> spread() const;

  static constexpr std::size_t saved = 8;  ///< numbers of a saved state
  [[nodiscard]] std::array<double, saved> save() const;
  static Oscillation restored(std::span<const double, saved> state);

 private:
  std::int64_t samples_ = 0, passages_ = 0;
  double time_ = 0, value_ = 0;        ///< of the last sample
  double first_ = 0, last_ = 0;        ///< s, passages
  double shortest_ = 0, longest_ = 0;  ///< s between two passages
};

}  // namespace equidem
