// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts that begin or end between two kicks of the Verlet schemes: their part of the step, and its energy balance.
///
/// A contact that begins in the drift before a half kick receives J/2, J = (k d + c v) dt, although it acted only for f
/// dt, f = d/(v dt). The true impulses of spring and dashpot are f/2 k d dt and c v f dt; without the correction a
/// spring removes 1/2 k (v dt)² f (1 - f) too much energy from the motion, on average (w dt)²/6 of the energy of an
/// impact, w² = k/m. The end of a contact is the mirror image.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "equidem/core/vector.hpp"

namespace equidem {

struct GrainSystem;
struct EnergyLedger;

/// A contact at the end of the drift in which it began, or at the start of the drift in which it ended.
struct TouchInstant {
  std::int32_t i = 0, j = 0;  ///< as in Candidate
  Vec2 normal;
  Vec2 arm_i, arm_j;               ///< from the centres, m; {} for a wall
  double closing = 0, slip = 0;    ///< mean over the drift, m/s
  double part = 1;                 ///< part of the drift in which the bodies touched
  double spring = 0, dashpot = 0;  ///< impulses on j along the normal in a whole kick, N s
  double decay = 0;                ///< c dt/m of the dashpot
  double tangential = 0;           ///< impulse on j in a whole kick, N s
  double tangential_dashpot = 0;   ///< part of `tangential` due to the dashpot, while sticking
  double stored = 0;               ///< energy of the tangential spring, J
  bool slides = false;
  bool pulls = false;  ///< the contact ends at zero overlap, not at zero force
};

/// Part of a drift in which bodies touch if they overlap by `overlap` at one end of it and are apart at the other.
inline double part_of_drift(double overlap, double speed, double step) {
  return overlap < speed * step ? overlap / (speed * step) : 1;
}

/// Impulse of the kick at the end of the drift in addition to J/2.
struct TouchImpulse {
  std::int32_t i = 0, j = 0;
  Vec2 normal, arm_i, arm_j;
  double spring = 0, dashpot = 0, tangential_spring = 0, tangential = 0;  ///< N s, on j
  double EnergyLedger::*taken = nullptr;  ///< ledger term of the energy that `tangential` removes
};

/// The impulses of bodies on a wall; work since the start.
struct WallLoad {
  Vec2 impulse, step_impulse;  ///< since the start without the present step, in this one; N s
  double step_angular = 0;     ///< about the place of the wall, N m s
  double work = 0;             ///< done by the wall, J

  void add_in_step(const WallLoad& other) {
    step_impulse += other.step_impulse;
    step_angular += other.step_angular;
    work += other.work;
  }
  void begin_step() {
    impulse += step_impulse;
    step_impulse = {};
    step_angular = 0;
  }
};

/// The sums of a step to which every contact adds.
struct ContactSums {
  EnergyLedger& lost;                      ///< losses and work since the start
  std::vector<TouchImpulse>& corrections;  ///< corrected_verlet: of the next kick
  std::vector<WallLoad>* on_walls;         ///< of each wall; may be empty where no wall is touched
};

/// Count the energy lost by a contact in the drift in which it began or ended; corrected_verlet: add its correction.
void begin_within_drift(const GrainSystem& system, const TouchInstant& contact, ContactSums sums);
void end_within_drift(const GrainSystem& system, const TouchInstant& contact, ContactSums sums);

/// Apply the stored corrections after the kick.
void give_touch_impulses(GrainSystem& system);

}  // namespace equidem
