// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/touch_instants.hpp"

#include <cmath>

#include "equidem/grains/grain_system.hpp"

namespace equidem {
namespace {

bool corrects(const GrainSystem& system) {
  return system.options.integrator == GrainOptions::Integrator::corrected_verlet;
}

TouchImpulse impulse_on(const TouchInstant& contact) {
  TouchImpulse impulse;
  impulse.i = contact.i;
  impulse.j = contact.j;
  impulse.normal = contact.normal;
  impulse.arm_i = contact.arm_i;
  impulse.arm_j = contact.arm_j;
  return impulse;
}

/// Velocity of the contact point of j, or of the wall in the drift, relative to that of i.
Vec2 relative_velocity(const GrainSystem& system, const TouchImpulse& impulse) {
  const auto at = [&](std::int32_t body, Vec2 arm) {
    const GrainMotion& motion = system.bodies.motions[static_cast<std::size_t>(body)];
    return motion.velocity + motion.spin * perpendicular(arm);
  };
  const Vec2 other = impulse.j >= 0 ? at(impulse.j, impulse.arm_j)
                                    : system.walls.places[static_cast<std::size_t>(~impulse.j)].passed_velocity;
  return other - at(impulse.i, impulse.arm_i);
}

/// In the part of the drift in which the contact lasts: its spring slackens by the slip, friction bounds it as the
/// normal force falls. \param given, normal impulses along the normal, in the last whole kick and in the part
double last_tangential(const GrainSystem& system, const TouchInstant& contact, double given, double normal) {
  Candidate candidate;
  candidate.i = contact.i;
  candidate.j = contact.j;
  const double friction = system.properties(candidate).friction;
  const double bound = friction * std::max(given, 0.0), kick = std::abs(contact.tangential);
  const double beyond_cap = contact.part * std::max(kick - bound, 0.0);
  const double most = (given > 0 ? friction * std::max(normal, 0.0) : 0) + beyond_cap;
  const bool slides = kick >= bound * (1 - 1e-9) && contact.tangential * contact.slip <= 0;
  if (slides) return std::copysign(most, contact.tangential);
  const double slack = contact.stored > 0 ? contact.tangential * contact.slip * contact.part / (2 * contact.stored) : 0;
  const double held = contact.tangential * contact.part * (1 - 0.5 * slack);
  return std::clamp(held, -most, most);
}

}  // namespace

void begin_within_drift(const GrainSystem& system, const TouchInstant& contact, ContactSums sums) {
  EnergyLedger& lost = sums.lost;
  lost.lost_dashpot += 0.5 * contact.dashpot * contact.closing;
  if (contact.slides) {
    lost.lost_slip -= 0.5 * contact.tangential * contact.slip + contact.stored;
  } else {
    lost.lost_tangential_dashpot -= 0.5 * contact.tangential_dashpot * contact.slip;
  }
  if (!corrects(system)) return;
  DriftShares share = system.law().shares_of_drift(contact.part);
  share.dashpot /= 1 + 0.5 * share.dashpot * contact.decay;
  TouchImpulse impulse = impulse_on(contact);
  impulse.spring = (share.spring - 0.5) * contact.spring;
  impulse.dashpot = (share.dashpot - 0.5) * contact.dashpot;
  if (contact.slides) {  // as the normal force
    const double normal = contact.spring + contact.dashpot;
    impulse.tangential = normal > 0 ? contact.tangential * ((impulse.spring + impulse.dashpot) / normal) : 0;
    impulse.taken = &EnergyLedger::lost_slip;
  } else {
    impulse.tangential_spring = 0.5 * (contact.part - 1) * (contact.tangential - contact.tangential_dashpot);
    impulse.tangential = (contact.part - 0.5) * contact.tangential_dashpot;
    impulse.taken = &EnergyLedger::lost_tangential_dashpot;
  }
  sums.corrections.push_back(impulse);
}

void end_within_drift(const GrainSystem& system, const TouchInstant& contact, ContactSums sums) {
  EnergyLedger& lost = sums.lost;
  const DriftShares share = system.law().shares_of_drift(contact.part);
  const double given = contact.spring + contact.dashpot;
  double true_one = given != 0 ? share.spring * contact.spring + share.dashpot * contact.dashpot : 0;
  if (!contact.pulls) true_one = std::max(true_one, 0.0);
  TouchImpulse impulse = impulse_on(contact);
  impulse.spring = (share.spring - 0.5) * contact.spring;
  impulse.dashpot = true_one - 0.5 * given - impulse.spring;
  impulse.tangential = last_tangential(system, contact, given, true_one) - 0.5 * contact.tangential;
  impulse.taken = &EnergyLedger::lost_release;
  lost.lost_dashpot += 0.5 * contact.dashpot * contact.closing;
  lost.lost_release += contact.stored - 0.5 * contact.tangential * contact.slip;
  if (given == 0) {  // the spring has nothing more to give: the dashpot takes what it holds
    lost.lost_dashpot += impulse.dashpot * contact.closing;
  } else if (corrects(system)) {
    sums.corrections.push_back(impulse);
  }
}

void give_touch_impulses(GrainSystem& system) {
  for (const TouchImpulse& impulse : system.touch_impulses) {
    const Vec2 tangent = perpendicular(impulse.normal);
    const Vec2 on_j = (impulse.spring + impulse.dashpot) * impulse.normal +
                      (impulse.tangential_spring + impulse.tangential) * tangent;
    const auto push = [&](std::int32_t body, Vec2 arm, Vec2 on) {
      const auto b = static_cast<std::size_t>(body);
      system.bodies.motions[b].velocity += system.bodies.constants[b].inverse_mass * on;
      system.bodies.motions[b].spin += system.bodies.constants[b].inverse_moment * cross(arm, on);
    };
    const Vec2 before = relative_velocity(system, impulse);
    push(impulse.i, impulse.arm_i, -on_j);
    if (impulse.j >= 0) {
      push(impulse.j, impulse.arm_j, on_j);
    } else {
      push_wall(system, impulse.j, system.bodies.motions[static_cast<std::size_t>(impulse.i)].position + impulse.arm_i,
                on_j, system.walls.places[static_cast<std::size_t>(~impulse.j)].passed_velocity, system.sums());
    }
    const Vec2 mean = 0.5 * (before + relative_velocity(system, impulse));
    system.lost.lost_dashpot -= impulse.dashpot * dot(mean, impulse.normal);
    system.lost.*impulse.taken -= impulse.tangential * dot(mean, tangent);
  }
  system.touch_impulses.clear();
}

}  // namespace equidem
