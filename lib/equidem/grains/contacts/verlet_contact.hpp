// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One contact in a step of the Verlet schemes: its impulse, and its losses in the drift before.
///
/// The kick J of an instant does work half with the velocity of the drift before it and half with that of the drift
/// after it: the loss of a contact in a drift is 0.5 (J_before + J_now) times its speed, less the energy stored in its
/// springs. No prediction is needed. A contact that begins or ends within a drift has one of the two kicks: the ledger
/// is of the first order of the step there.
#pragma once

#include <algorithm>
#include <cmath>

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Contact point of two bodies. The arms lead from the centres of mass to the contact point; the arm of a wall is {}.
struct TouchPlace {
  double overlap = 0;
  Vec2 normal, arm_i, arm_j;
};

/// Mean velocities of a contact in the drift before the instant, and its overlap at the start of that drift.
struct ContactDrift {
  double closing = 0, slip = 0;  ///< m/s
  double overlap = 0;            ///< m
};

/// Impulse of the spring in a whole kick, N s.
template <class Law>
[[gnu::always_inline]] inline double spring_impulse(const GrainSystem& system, const Candidate& candidate,
                                                    double overlap) {
  const double depth = std::max(overlap, 0.0) / system.length;
  return Law::spring(candidate.a, depth) * candidate.reduced_mass * (system.length / system.dt());
}

inline Vec2 impulse_of(const Candidate& candidate) {
  return candidate.impulse * candidate.normal + candidate.tangential_impulse * perpendicular(candidate.normal);
}

inline Vec2 passed_velocity(const GrainSystem& system, const Candidate& candidate) {
  return candidate.j >= 0 ? Vec2{} : system.walls.places[static_cast<std::size_t>(~candidate.j)].passed_velocity;
}

/// Count what the body gave to a wall in the drift before: half of each of the kicks at its ends.
/// \param kicks sum of both, N s
inline void push_wall_in_drift(const GrainSystem& system, const Candidate& candidate, Vec2 arm, Vec2 kicks,
                               ContactSums sums) {
  const Vec2 point = system.bodies.motions[static_cast<std::size_t>(candidate.i)].position + arm;
  push_wall(system, candidate.j, point, 0.5 * kicks, passed_velocity(system, candidate), sums);
}

/// End a contact: its last kick does half its work with the velocity of the drift in which it ends.
template <class Law>
void end_contact(const GrainSystem& system, Candidate& candidate, Vec2 arm, const ContactDrift& drift,
                 ContactSums sums) {
  const double spring = spring_impulse<Law>(system, candidate, drift.overlap);
  if (candidate.impulse != 0) {
    sums.lost.lost_dashpot += 0.5 * (candidate.impulse - spring) * drift.closing;
  } else {  // the dashpot takes what the spring holds: k d^(p + 1)/(p + 1)
    sums.lost.lost_dashpot += spring * drift.overlap / ((1 + Law::spring_power) * system.dt());
  }
  sums.lost.lost_release += 0.5 * candidate.sliding.stiffness * candidate.stretch * candidate.stretch -
                            0.5 * candidate.tangential_impulse * drift.slip;
  if (candidate.j < 0) push_wall_in_drift(system, candidate, arm, impulse_of(candidate), sums);
  candidate.stretch = 0;
  forget_contact(candidate, sums.lost);
}

/// One step of a contact; its state is stored in `candidate`.
/// \param closing, slip velocities for the law, m/s
/// \return impulse on j
template <class Law, bool friction>
[[gnu::always_inline]] inline Vec2 step_contact(const GrainSystem& system, Candidate& candidate, const TouchPlace& now,
                                                double closing, double slip, const ContactDrift& drift,
                                                const Sliding& sliding, ContactSums sums) {
  const double dt = system.dt();
  const bool begins = !candidate.touching;
  const double depth = now.overlap / system.length, sigma = closing * dt / system.length;
  const ContactStep step = force_step<Law>(depth, sigma, candidate.a, candidate.dissipation, candidate.attraction);
  const double impulse = -step.change * candidate.reduced_mass * (system.length / dt);
  const double spring = spring_impulse<Law>(system, candidate, now.overlap);
  const Vec2 pushed_before = begins ? Vec2{} : impulse_of(candidate);

  double tangential = 0;
  SlidingStep slide;
  const double stretch_before = candidate.stretch;
  if constexpr (friction) {
    if (sliding.coefficient > 0) {
      const double normal_force = std::max(impulse, 0.0) / dt;
      // where bodies of parts begin to touch, or a simulation, no place before is known
      slide = sliding_step(sliding, candidate.stretch, slip, normal_force, dt,
                           (candidate.steps > 0 ? drift.slip : slip) * dt);
      tangential = slide.force * dt;
      candidate.stretch = slide.stretch;
    }
  }
  if (begins) {
    sums.lost.lost_dashpot += 0.5 * (impulse - spring) * drift.closing;
    if (slide.slides) {
      sums.lost.lost_slip -=
          0.5 * tangential * drift.slip + 0.5 * sliding.stiffness * candidate.stretch * candidate.stretch;
    } else {
      sums.lost.lost_tangential_dashpot += 0.5 * sliding.dashpot * slip * dt * drift.slip;
    }
  } else {
    const double spring_before = spring_impulse<Law>(system, candidate, drift.overlap);
    sums.lost.lost_dashpot += 0.5 * drift.closing * ((candidate.impulse - spring_before) + (impulse - spring));
    if constexpr (friction) {
      const double released =
          0.5 * sliding.stiffness * (stretch_before - candidate.stretch) * (stretch_before + candidate.stretch);
      const double taken = released - 0.5 * (candidate.tangential_impulse + tangential) * drift.slip;
      if (slide.slides) {
        sums.lost.lost_slip += taken;
      } else if (sliding.dashpot > 0) {
        sums.lost.lost_tangential_dashpot += taken;
      }
    }
  }
  candidate.touching = true;
  ++candidate.steps;
  candidate.overlap = now.overlap;
  candidate.closing = closing;
  candidate.normal = now.normal;
  candidate.impulse = impulse;
  candidate.tangential_impulse = tangential;
  const Vec2 on_j = impulse * now.normal + tangential * perpendicular(now.normal);
  if (candidate.j < 0) push_wall_in_drift(system, candidate, now.arm_i, pushed_before + on_j, sums);
  return on_j;
}

}  // namespace equidem
