// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rolling resistance and cohesion: constants and state of the contacts that have them.
///
/// Rolling (Iwashita and Oda 1998; Ai et al. 2011, type C with f = 0). The rotation of j relative to i stretches a
/// spring at the lever R, R = R_i R_j/(R_i + R_j), at a wall R_i, of parts of bodies the radii of discs of equal area.
/// Its stretch is R times that rotation, its force R_r = k_r/R² times the stretch, its moment R times the force. Spring
/// and dashpot together carry at most mu_r times the repulsion, as in sliding; at the limit the dashpot gives nothing.
///
/// Cohesion. Bodies whose gap is less than the range attract each other by a constant force F_c, overlapping ones too:
/// N = repulsion - F_c, with the potential energy F_c (gap - range). Repulsion is the force of spring and dashpot. Both
/// limits of friction are measured by it: mu (N + F_c), the limit of Coulomb with a cohesion, and mu_r (N + F_c) R.
#pragma once

#include <cmath>
#include <cstddef>

namespace equidem {

/// Constants of two kinds of bodies.
struct EffectConstants {
  double rolling_friction = 0;   ///< mu_r
  double rolling_stiffness = 0;  ///< k_r/R², N/m
  double rolling_damping = 0;    ///< zeta_r: dashpot 2 zeta_r sqrt(I k_r), 1/I = 1/I_i + 1/I_j
  double attraction = 0;         ///< F_c, N
  double range = 0;              ///< m
};

/// The bodies of a contact as its rolling sees them.
struct RollingBodies {
  double radius_i = 0, radius_j = 0;    ///< m; of a wall infinite
  double inverse_i = 0, inverse_j = 0;  ///< 1/I
};

/// Eight contacts, each number a column.
struct alignas(64) ContactEffects {
  double lever[8];     ///< R, m
  double share[8];     ///< R/R_j
  double friction[8];  ///< mu_r
  double stiffness[8];
  double dashpot[8];        ///< at the lever, times dt, kg
  double half_mobility[8];  ///< R²/(2 I), 1/kg
  double attraction[8];     ///< times dt, N s
  double range[8];
  // of the last step
  double stretch[8];  ///< m
  double impulse[8];  ///< on j at the lever, N s

  void set(std::size_t lane, const EffectConstants& constants, const RollingBodies& bodies, double dt) {
    const double by_j = 1 / (1 + bodies.radius_i / bodies.radius_j);
    lever[lane] = bodies.radius_i * by_j;
    share[lane] = 1 - by_j;
    friction[lane] = constants.rolling_friction;
    stiffness[lane] = constants.rolling_stiffness;
    const double inverse = lever[lane] * lever[lane] * (bodies.inverse_i + bodies.inverse_j);
    dashpot[lane] = 2 * constants.rolling_damping * std::sqrt(constants.rolling_stiffness / inverse) * dt;
    half_mobility[lane] = 0.5 * inverse;
    attraction[lane] = constants.attraction * dt;
    range[lane] = constants.range;
    set_state(lane, 0, 0);
  }
  void set_state(std::size_t lane, double rolled, double pushed) {
    stretch[lane] = rolled;
    impulse[lane] = pushed;
  }
  /// Energy of the rolling spring, J.
  [[nodiscard]] double elastic(std::size_t lane) const { return 0.5 * stiffness[lane] * stretch[lane] * stretch[lane]; }
};

}  // namespace equidem
