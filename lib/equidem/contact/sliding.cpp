// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/sliding.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace equidem {
namespace {

/// mu N; a normal force that attracts carries no friction.
double yield_of(const Sliding& law, double normal_force) {
  return law.coefficient * std::max(normal_force, 0.0);
}

SlidingStep stick(const Sliding& law, double stretch, double resistance, double velocity, double step) {
  return {.force = -resistance,
          .stretch = law.stiffness > 0 ? stretch + velocity * step : 0,
          .dashpot_loss = law.dashpot * velocity * velocity * step};
}

/// \param friction mu N, with the sign of the force that passed it
/// \param velocity mean over the step under that friction
SlidingStep slide(const Sliding& law, double stretch, double friction, double velocity, double step) {
  // Held at what friction carries, but never carried further than the bodies moved: so work - energy stored >= 0.
  const double largest = law.stiffness > 0 ? std::abs(friction) / law.stiffness : 0;
  const double end = std::clamp(stretch + velocity * step, -largest, largest);
  const double released = law.stiffness * (stretch - end) * (stretch + end) / 2;
  const double dashpot = law.cap == FrictionCap::spring_alone ? law.dashpot * velocity : 0;
  return {.force = -(friction + dashpot),
          .stretch = end,
          .slip_loss = friction * velocity * step + released,
          .dashpot_loss = dashpot * velocity * step,
          .slides = true};
}

}  // namespace

SlidingStep sliding_step(const Sliding& law, double stretch, double velocity, double normal_force, double step) {
  const double yield = yield_of(law, normal_force);
  if (is_rigid(law)) {
    const double friction = velocity == 0 ? 0 : std::copysign(yield, velocity);
    return slide(law, 0, friction, velocity, step);
  }
  const double spring = law.stiffness * (stretch + velocity * step), dashpot = law.dashpot * velocity;
  const double capped = law.cap == FrictionCap::whole_force ? spring + dashpot : spring;
  if (std::abs(capped) <= yield) return stick(law, stretch, spring + dashpot, velocity, step);
  return slide(law, stretch, std::copysign(yield, capped), velocity, step);
}

SlidingStep sliding_step_midpoint(const Sliding& law, double stretch, double velocity, double mass, double normal_force,
                                  double step) {
  assert(mass > 0 && step > 0);
  const double yield = yield_of(law, normal_force);
  const double mobility = step / (2 * mass);  // mean velocity per mean force
  if (is_rigid(law)) {
    const double friction = std::clamp(velocity / (2 * mobility), -yield, yield);
    return slide(law, 0, friction, velocity - mobility * friction, step);
  }
  // Sticking: spring and dashpot resist with kT (stretch + mean dt/2) + c mean, and mean = velocity - mobility * that.
  const double rate = law.stiffness * step / 2 + law.dashpot, share = 1 + mobility * rate;
  const double mean = (velocity - mobility * law.stiffness * stretch) / share;
  const double resistance = (law.stiffness * stretch + rate * velocity) / share;
  const bool whole = law.cap == FrictionCap::whole_force;
  const double capped = whole ? resistance : resistance - law.dashpot * mean;
  if (std::abs(capped) <= yield) return stick(law, stretch, resistance, mean, step);
  const double friction = std::copysign(yield, capped);
  const double slipping = (velocity - mobility * friction) / (whole ? 1 : 1 + mobility * law.dashpot);
  return slide(law, stretch, friction, slipping, step);
}

}  // namespace equidem
