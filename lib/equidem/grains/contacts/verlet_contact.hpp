// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One contact in a step of the Verlet schemes: its impulse, and its losses in the drift before.
///
/// The kick J of an instant does work half with the velocity of the drift before it and half with that of the drift
/// after it: the loss of a contact in a drift is 0.5 (J_before + J_now) times its speed, less the energy stored in its
/// springs. No prediction is needed.
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

/// Change of slip velocity in a step by all forces but the contact's own, m/s, and 1/tangential mass, 1/kg.
struct SlipByOthers {
  double gain = 0, inverse_mass = 0;
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

/// End a contact without further loss.
template <class Law>
void end_contact(const GrainSystem& system, Candidate& candidate, const TouchPlace& place, const ContactDrift& drift,
                 ContactSums sums) {
  TouchInstant end;
  end.i = candidate.i;
  end.j = candidate.j;
  end.normal = place.normal;
  end.arm_i = place.arm_i;
  end.arm_j = place.arm_j;
  end.closing = drift.closing;
  end.slip = drift.slip;
  end.part = part_of_drift(drift.overlap, -drift.closing, system.dt());
  end.spring = spring_impulse<Law>(system, candidate, drift.overlap);
  end.dashpot = candidate.impulse - end.spring;
  end.tangential = candidate.tangential_impulse;
  end.stored = 0.5 * candidate.sliding.stiffness * candidate.stretch * candidate.stretch;
  end.pulls = candidate.attraction;
  if (candidate.j < 0) push_wall_in_drift(system, candidate, place.arm_i, impulse_of(candidate), sums);
  end_within_drift(system, end, sums);
  candidate.stretch = 0;
  forget_contact(candidate, sums.lost);
}

/// One step of a contact; its state is stored in `candidate`.
/// \param closing, slip velocities for the law, m/s
/// \param others returns SlipByOthers: friction without a spring stops a slip but does not reverse it
/// \return impulse on j
template <class Law, bool friction, class Others>
[[gnu::always_inline]] inline Vec2 step_contact(const GrainSystem& system, Candidate& candidate, const TouchPlace& now,
                                                double closing, double slip, const ContactDrift& drift,
                                                const Sliding& sliding, const Others& others, ContactSums sums) {
  const double dt = system.dt();
  const bool begins = !candidate.touching;
  const double depth = now.overlap / system.length, sigma = closing * dt / system.length;
  const ContactStep step = force_step<Law>(depth, sigma, candidate.a, candidate.dissipation, candidate.attraction);
  const double impulse = -step.change * candidate.reduced_mass * (system.length / dt);
  const double spring = spring_impulse<Law>(system, candidate, now.overlap);
  const Vec2 pushed_before = begins ? Vec2{} : impulse_of(candidate);

  const double part = begins ? part_of_drift(now.overlap, drift.closing, dt) : 1;
  double tangential = 0;
  SlidingStep slide;
  const double stretch_before = candidate.stretch;
  if constexpr (friction) {
    if (sliding.coefficient > 0) {
      if (begins && system.options.integrator == GrainOptions::Integrator::corrected_verlet) {
        candidate.stretch -= (1 - part) * slip * dt;
      }
      const double normal_force = std::max(impulse, 0.0) / dt;
      if (is_rigid(sliding)) {
        const SlipByOthers by_others = others();
        slide = sliding_step_midpoint(sliding, 0, slip + by_others.gain, by_others.inverse_mass, normal_force, dt);
      } else {
        // where bodies of parts begin to touch, or a simulation, no place before is known
        slide = sliding_step(sliding, candidate.stretch, slip, normal_force, dt,
                             (candidate.steps > 0 ? drift.slip : slip) * dt);
      }
      tangential = slide.force * dt;
      candidate.stretch = slide.stretch;
    }
  }
  if (begins) {
    TouchInstant begin;
    begin.i = candidate.i;
    begin.j = candidate.j;
    begin.normal = now.normal;
    begin.arm_i = now.arm_i;
    begin.arm_j = now.arm_j;
    begin.closing = drift.closing;
    begin.slip = drift.slip;
    begin.part = part;
    begin.spring = spring;
    begin.dashpot = impulse - spring;
    begin.decay = Law::dashpot(candidate.dissipation, depth);
    begin.tangential = tangential;
    begin.tangential_dashpot = slide.slides ? 0 : -sliding.dashpot * slip * dt;
    begin.stored = 0.5 * sliding.stiffness * candidate.stretch * candidate.stretch;
    begin.slides = slide.slides;
    begin_within_drift(system, begin, sums);
  } else {
    const double spring_before = spring_impulse<Law>(system, candidate, drift.overlap);
    sums.lost.lost_dashpot += 0.5 * drift.closing * ((candidate.impulse - spring_before) + (impulse - spring));
    if constexpr (friction) {
      const double released =
          0.5 * sliding.stiffness * (stretch_before - candidate.stretch) * (stretch_before + candidate.stretch);
      const double taken = released - 0.5 * (candidate.tangential_impulse + tangential) * drift.slip;
      if (slide.slides) {
        const double drag = sliding.cap == FrictionCap::spring_alone ? sliding.dashpot * slip * drift.slip * dt : 0;
        sums.lost.lost_slip += taken - drag;
        sums.lost.lost_tangential_dashpot += drag;
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
