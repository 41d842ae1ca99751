// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/touch_instants.hpp"

#include "equidem/grains/grain_system.hpp"

namespace equidem {
namespace {

/// Impulses of spring and dashpot in a part of a drift, over those of a whole kick: of k d^p and c d^q v, d linear in time.
struct Shares {
  double spring = 0, dashpot = 0;
};

Shares shares_of(const GrainSystem& system, double part) {
  const bool hertz = system.options.law == NormalLaw::hertz_dashpot;
  return hertz ? Shares{part / 2.5, part / 1.25} : Shares{part / 2, part};
}

bool corrects(const GrainSystem& system) {
  return system.options.scheme == GrainOptions::Scheme::corrected_verlet;
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

/// Of the contact point of j, or of the wall in the drift, over that of i.
Vec2 relative_velocity(const GrainSystem& system, const TouchImpulse& impulse) {
  const auto at = [&](std::int32_t body, Vec2 arm) {
    const GrainMotion& motion = system.motions[static_cast<std::size_t>(body)];
    return motion.velocity + motion.spin * perpendicular(arm);
  };
  const Vec2 other = impulse.j >= 0 ? at(impulse.j, impulse.arm_j)
                                    : system.walls[static_cast<std::size_t>(~impulse.j)].passed_velocity;
  return other - at(impulse.i, impulse.arm_i);
}

}  // namespace

void begin_within_drift(GrainSystem& system, const TouchInstant& contact) {
  GrainLedger& lost = system.lost;
  lost.lost_dashpot += 0.5 * contact.dashpot * contact.closing;
  if (contact.slides) {
    lost.lost_slip -= 0.5 * contact.tangential * contact.slip + contact.stored;
  } else {
    lost.lost_tangential_dashpot -= 0.5 * contact.tangential_dashpot * contact.slip;
  }
  if (!corrects(system)) return;
  Shares share = shares_of(system, contact.part);
  share.dashpot /= 1 + 0.5 * share.dashpot * contact.decay;
  TouchImpulse impulse = impulse_on(contact);
  impulse.spring = (share.spring - 0.5) * contact.spring;
  impulse.dashpot = (share.dashpot - 0.5) * contact.dashpot;
  if (contact.slides) {  // as the normal force
    const double normal = contact.spring + contact.dashpot;
    impulse.tangential = normal > 0 ? contact.tangential * ((impulse.spring + impulse.dashpot) / normal) : 0;
    impulse.taken = &GrainLedger::lost_slip;
  } else {
    impulse.tangential_spring = 0.5 * (contact.part - 1) * (contact.tangential - contact.tangential_dashpot);
    impulse.tangential = (contact.part - 0.5) * contact.tangential_dashpot;
    impulse.taken = &GrainLedger::lost_tangential_dashpot;
  }
  system.touch_impulses.push_back(impulse);
}

void end_within_drift(GrainSystem& system, const TouchInstant& contact) {
  GrainLedger& lost = system.lost;
  const Shares share = shares_of(system, contact.part);
  const double given = contact.spring + contact.dashpot;
  double true_one = share.spring * contact.spring + share.dashpot * contact.dashpot;
  if (!contact.pulls) true_one = std::max(true_one, 0.0);
  TouchImpulse impulse = impulse_on(contact);
  impulse.spring = (share.spring - 0.5) * contact.spring;
  impulse.dashpot = true_one - 0.5 * given - impulse.spring;
  impulse.tangential = 0.5 * (contact.part - 1) * contact.tangential;
  impulse.taken = &GrainLedger::lost_release;
  lost.lost_dashpot += 0.5 * contact.dashpot * contact.closing;
  lost.lost_release += contact.stored - 0.5 * contact.tangential * contact.slip;
  if (given == 0) {  // the spring has nothing more to give: the dashpot takes what it holds
    lost.lost_dashpot += impulse.dashpot * contact.closing;
  } else if (corrects(system)) {
    system.touch_impulses.push_back(impulse);
  }
}

void give_touch_impulses(GrainSystem& system) {
  for (const TouchImpulse& impulse : system.touch_impulses) {
    const Vec2 tangent = perpendicular(impulse.normal);
    const Vec2 on_j = (impulse.spring + impulse.dashpot) * impulse.normal +
                      (impulse.tangential_spring + impulse.tangential) * tangent;
    const auto push = [&](std::int32_t body, Vec2 arm, Vec2 on) {
      const auto b = static_cast<std::size_t>(body);
      system.motions[b].velocity += system.bodies[b].inverse_mass * on;
      system.motions[b].spin += system.bodies[b].inverse_moment * cross(arm, on);
    };
    const Vec2 before = relative_velocity(system, impulse);
    push(impulse.i, impulse.arm_i, -on_j);
    if (impulse.j >= 0) {
      push(impulse.j, impulse.arm_j, on_j);
    } else {
      system.lost.work_of_walls -= dot(on_j, system.walls[static_cast<std::size_t>(~impulse.j)].passed_velocity);
    }
    const Vec2 mean = 0.5 * (before + relative_velocity(system, impulse));
    system.lost.lost_dashpot -= impulse.dashpot * dot(mean, impulse.normal);
    system.lost.*impulse.taken -= impulse.tangential * dot(mean, tangent);
  }
  system.touch_impulses.clear();
}

}  // namespace equidem
