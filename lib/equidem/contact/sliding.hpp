// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tangential contact in one step: spring, dashpot, Coulomb's limit.
///
/// The spring is stretched by the slip x, x' = v; it resists with kT x, the dashpot with c v. Friction carries at most
/// mu N, N the normal force (none where N < 0). While sliding the spring keeps its stretch, at most mu N/kT; the rest
/// of the work is lost. Without spring and dashpot (kT = c = 0) the contact always slides: mu N against the velocity.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>

#include "equidem/core/names.hpp"

namespace equidem {

/// All >= 0.
struct Sliding {
  double stiffness = 0;    ///< kT, N/m
  double dashpot = 0;      ///< c, N s/m
  double coefficient = 0;  ///< mu
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

/// mu N; a normal force that attracts carries no friction.
inline double yield_of(const Sliding& law, double normal_force) {
  return law.coefficient * std::max(normal_force, 0.0);
}

/// \param resistance of spring and dashpot
/// \param velocity mean over the step
/// \param way slip in the step, m
inline SlidingStep stick_through(const Sliding& law, double stretch, double resistance, double velocity, double step,
                                 double way) {
  return {.force = -resistance,
          .stretch = law.stiffness > 0 ? stretch + way : 0,
          .dashpot_loss = law.dashpot * velocity * velocity * step};
}

/// \param friction mu N, with the sign of the force that passed it
/// \param velocity mean over the step under that friction
/// \param way slip in the step, m
inline SlidingStep slide_through(const Sliding& law, double stretch, double friction, double velocity, double step,
                                 double way) {
  // Held at what friction carries, but never carried further than the bodies moved: so work - energy stored >= 0.
  const double largest = law.stiffness > 0 ? std::abs(friction) / law.stiffness : 0;
  const double end = std::clamp(stretch + way, -largest, largest);
  const double released = law.stiffness * (stretch - end) * (stretch + end) / 2;
  return {.force = -friction, .stretch = end, .slip_loss = friction * velocity * step + released, .slides = true};
}

/// Explicit: force from the stretch at the end of the step with the velocity given (LAMMPS, YADE, Sukegawa
/// (2.9)-(2.16)). The work of a spring that sticks exceeds the energy it stores by kT (v dt)²/2: the error of the
/// integrator, counted nowhere. kT = c = 0: mu N even if that reverses the slip within the step; use the midpoint rule.
/// The losses are those at the velocity given.
/// \param way of the spring, m: in Verlet schemes that of the drift, in which the normal turns. By the
///        velocity at its end the energy of the spring would differ from the work on it by the first order of the step.
inline SlidingStep sliding_step(const Sliding& law, double stretch, double velocity, double normal_force, double step,
                                double way) {
  const double yield = yield_of(law, normal_force);
  if (is_rigid(law)) {
    const double friction = velocity == 0 ? 0 : std::copysign(yield, velocity);
    return slide_through(law, 0, friction, velocity, step, way);
  }
  const double resistance = law.stiffness * (stretch + way) + law.dashpot * velocity;
  if (std::abs(resistance) <= yield) return stick_through(law, stretch, resistance, velocity, step, way);
  return slide_through(law, stretch, std::copysign(yield, resistance), velocity, step, way);
}
inline SlidingStep sliding_step(const Sliding& law, double stretch, double velocity, double normal_force, double step) {
  return sliding_step(law, stretch, velocity, normal_force, step, velocity * step);
}

/// Midpoint rule: force, stretch and velocity consistent over the step, so that sticking keeps energy and sliding only
/// loses it. kT = c = 0: at most what stops the slip within the step, so that a slip that stops stays stopped; under a
/// steady outside acceleration g that friction can hold, a slip of g dt/2 remains.
/// \param velocity mean over the step as all other forces make it: of constant ones, at the start plus half its change
/// \param inverse_mass of the effective tangential mass: 1/m_i + 1/m_j + r_i²/I_i + r_j²/I_j, 1/kg
inline SlidingStep sliding_step_midpoint(const Sliding& law, double stretch, double velocity, double inverse_mass,
                                         double normal_force, double step) {
  assert(inverse_mass > 0 && step > 0);
  const double yield = yield_of(law, normal_force);
  const double mobility = 0.5 * step * inverse_mass;  // mean velocity per mean force
  if (is_rigid(law)) {
    const double friction = std::clamp(velocity / (2 * mobility), -yield, yield);
    return slide_through(law, 0, friction, velocity - mobility * friction, step, 0);
  }
  // Sticking: spring and dashpot resist with kT (stretch + mean dt/2) + c mean, and mean = velocity - mobility * that.
  const double rate = law.stiffness * step / 2 + law.dashpot, share = 1 + mobility * rate;
  const double mean = (velocity - mobility * law.stiffness * stretch) / share;
  const double resistance = (law.stiffness * stretch + rate * velocity) / share;
  if (std::abs(resistance) <= yield) return stick_through(law, stretch, resistance, mean, step, mean * step);
  const double friction = std::copysign(yield, resistance);
  const double slipping = velocity - mobility * friction;
  return slide_through(law, stretch, friction, slipping, step, slipping * step);
}

}  // namespace equidem
