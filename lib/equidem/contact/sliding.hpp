// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tangential contact in one step: spring, dashpot, Coulomb's limit.
///
/// The spring is stretched by the slip x, x' = v; it resists with kT x, the dashpot with c v. Friction carries at most
/// mu N, N the normal force (none where N < 0). While sliding the spring keeps its stretch, at most mu N/kT; the rest
/// of the work is lost. Without spring and dashpot (kT = c = 0) the contact always slides: mu N against the velocity.
#pragma once

#include "equidem/core/names.hpp"

namespace equidem {

/// Force that is limited by friction.
enum class FrictionCap {
  whole_force,   ///< |T| <= mu N of spring and dashpot together; the dashpot is inactive while sliding
  spring_alone,  ///< only the spring (Sukegawa (2.16)); the dashpot adds to it
};

template <>
struct EnumNames<FrictionCap> {
  using enum FrictionCap;
  static constexpr const char* what = "limit of friction";
  static constexpr NamedValue<FrictionCap> list[] = {{whole_force, "whole_force"}, {spring_alone, "spring_alone"}};
};

/// All >= 0.
struct Sliding {
  double stiffness = 0;    ///< kT, N/m
  double dashpot = 0;      ///< c, N s/m
  double coefficient = 0;  ///< mu
  FrictionCap cap = FrictionCap::whole_force;
};

/// Whether there is neither spring nor dashpot.
inline bool is_rigid(const Sliding& law) {
  return law.stiffness == 0 && law.dashpot == 0;
}

struct SlidingStep {
  double force = 0;    ///< mean over the step, on the body whose slip velocity is given: negative where it resists a
                       ///< positive velocity
  double stretch = 0;  ///< of the spring at the end of the step, m
  double slip_loss = 0,
         dashpot_loss = 0;  ///< J, >= 0: work done on the contact at the mean velocity, less energy stored
  bool slides = false;
};

/// Explicit: force from the stretch at the end of the step with the velocity given (LAMMPS, YADE, Sukegawa
/// (2.9)-(2.16)). The work of a spring that sticks exceeds the energy it stores by kT (v dt)²/2: the error of the
/// integrator, counted nowhere. kT = c = 0: mu N even if that reverses the slip within the step; use the midpoint rule.
/// The losses are those at the velocity given.
SlidingStep sliding_step(const Sliding& law, double stretch, double velocity, double normal_force, double step);

/// Midpoint rule: force, stretch and velocity consistent over the step, so that sticking keeps energy and sliding only
/// loses it. kT = c = 0: at most what stops the slip within the step, so that a slip that stops stays stopped; under a
/// steady outside acceleration g that friction can hold, a slip of g dt/2 remains.
/// \param velocity mean over the step as all other forces make it: of constant ones, at the start plus half its change
/// \param mass effective tangential mass: 1/(1/m_i + 1/m_j + r_i²/I_i + r_j²/I_j), kg
SlidingStep sliding_step_midpoint(const Sliding& law, double stretch, double velocity, double mass, double normal_force,
                                  double step);

}  // namespace equidem
