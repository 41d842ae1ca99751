// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A rectangular cell whose content repeats along x, or along x and y, and how it deforms.
#pragma once

#include <optional>
#include <string>

#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/motion/schedule.hpp"

namespace equidem {

struct GrainScene;
struct GrainOptions;

/// Which stress a periodic cell keeps: it stretches in each step at the rate e' = (relaxation (W - S) + D e)/(C dt +
/// D), at most max_rate either way; W is the wanted stress, S that of the last step, e the rate of the last step, C and
/// D are the stiffness and the viscosity of the cell if all discs follow the stretch. Without contacts it closes in at
/// max_rate.
struct CellServo {
  std::optional<Schedule> stress_xx = {}, stress_yy = {};  ///< Pa, tension positive
  double max_rate = 0;                                     ///< 1/s, > 0
  double relaxation = 0.1;                                 ///< in (0, 1]
  bool goes_on_xx = false, goes_on_yy = false;             ///< as Servo::goes_on, of either stress
};

/// The bodies repeat at all sums of whole multiples of the periods. A period along y shifts with simple shear (Lees and
/// Edwards, J. Phys. C 5, 1921, 1972).
///
/// A deforming cell has the velocity gradient L = [[xx, xy], [0, yy]] throughout. The velocity of a body is the
/// peculiar one, u: its centre moves at u + L (x - centre of the cell), all its images have the same u, and m du/dt = f
/// - m L u (SLLOD: Evans and Morriss, Statistical Mechanics of Nonequilibrium Liquids, 1990). At a constant shear rate
/// this is Newton's law for the velocity u + L x. Results do not depend on where the cell is cut.
struct PeriodicCell {
  enum class Along { x, xy } along = Along::xy;
  Vec2 corner = {};                                   ///< lower left, m
  double width = 0, height = 0;                       ///< m; along x alone the height is 0
  double shift = 0;                                   ///< of the period along y, along x, m
  Schedule rate_xx = {}, rate_yy = {}, rate_xy = {};  ///< L, 1/s
  std::optional<CellServo> servo = {};
  std::string place = {};  ///< in the user's input, for messages; empty: not known

  [[nodiscard]] bool has_rates() const {
    const auto acts = [](const Schedule& rate) { return rate.changes() || rate.value != 0; };
    return acts(rate_xx) || acts(rate_yy) || acts(rate_xy);
  }
  [[nodiscard]] bool deforms() const { return servo.has_value() || has_rates(); }
};

template <>
struct EnumNames<PeriodicCell::Along> {
  using enum PeriodicCell::Along;
  static constexpr const char* what = "directions of periods";
  static constexpr NamedValue<PeriodicCell::Along> list[] = {{xy, "xy"}, {x, "x"}};
};

/// Check the cell of a scene that has one.
/// \throws Error (bad_input): periods shorter than two of the largest diameters, a wall that does not repeat itself,
///         what periodic cells do not carry (maps, exact_flow, ellipses by enlarged ones, shapes that always slide),
///         gravity where there is no floor, a rate and a stress of one component, a deforming cell that is not periodic
///         along y or stepped by another integrator than velocity_verlet, a body that moves further than the smallest
///         radius in a step
void check_cell(const GrainScene& scene, const GrainOptions& options);

}  // namespace equidem
