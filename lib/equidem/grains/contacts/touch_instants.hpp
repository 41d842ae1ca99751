// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts that begin or end between two kicks of the Verlet schemes: their part of the step, and where its energy
/// goes.
///
/// A half kick gives a contact that begins in the drift before it J/2, J = (k d + c v) dt, though it has pushed only
/// for f dt, f = d/(v dt). What spring and dashpot did then is f/2 k d dt and c v f dt; without that a spring takes 1/2
/// k (v dt)² f (1 - f) too much from the motion, (w dt)²/6 of the energy of an impact in the mean, w² = k/m. The end is
/// the mirror image.
#pragma once

#include <algorithm>
#include <cstdint>

#include "equidem/core/vector.hpp"

namespace equidem {

struct GrainSystem;
struct EnergyLedger;

/// A contact at the end of the drift in which it began, or at the start of the drift in which it ended.
struct TouchInstant {
  std::int32_t i = 0, j = 0;  ///< as of a Candidate
  Vec2 normal;
  Vec2 arm_i, arm_j;               ///< from the centres, m; of a wall {}
  double closing = 0, slip = 0;    ///< mean over the drift, m/s
  double part = 1;                 ///< of the drift in which the bodies touched
  double spring = 0, dashpot = 0;  ///< impulses on j along the normal in a whole kick, N s
  double decay = 0;                ///< c dt/m of the dashpot
  double tangential = 0;           ///< impulse on j in a whole kick, N s
  double tangential_dashpot = 0;   ///< of that, where it sticks
  double stored = 0;               ///< in the tangential spring, J
  bool slides = false;
  bool pulls = false;  ///< it ends at zero overlap, not at zero force
};

/// Part of a drift in which bodies touch that overlap by `overlap` at one end of it and are apart at the other.
inline double part_of_drift(double overlap, double speed, double step) {
  return overlap < speed * step ? overlap / (speed * step) : 1;
}

/// What the kick at the end of the drift gives besides J/2.
struct TouchImpulse {
  std::int32_t i = 0, j = 0;
  Vec2 normal, arm_i, arm_j;
  double spring = 0, dashpot = 0, tangential_spring = 0, tangential = 0;  ///< N s, on j
  double EnergyLedger::*taken = nullptr;                                  ///< where what `tangential` takes is counted
};

/// Count what a contact took in the drift in which it began or ended; corrected_verlet: see to it that it gets its
/// part.
void begin_within_drift(GrainSystem& system, const TouchInstant& contact);
void end_within_drift(GrainSystem& system, const TouchInstant& contact);

/// After the kick.
void give_touch_impulses(GrainSystem& system);

}  // namespace equidem
