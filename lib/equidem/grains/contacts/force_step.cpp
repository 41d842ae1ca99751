// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/force_step.hpp"

#include <algorithm>

#include "equidem/contact/laws/visit.hpp"
#include "equidem/grains/contacts/meeting.hpp"
#include "equidem/grains/contacts/move_bodies.hpp"
#include "equidem/grains/contacts/verlet_contact.hpp"

namespace equidem {
namespace {

template <class Law>
ContactStep normal_step(const Candidate& candidate, double depth, double closing) {
  if constexpr (Law::kind == LawKind::force) {
    return force_step<Law>(depth, closing, candidate.a, candidate.dissipation, candidate.attraction);
  } else {
    static_assert(Law::kind == LawKind::map);
    return Law::step(depth, closing, candidate.a, candidate.dissipation, !candidate.touching);
  }
}

/// Give an impulse to j, its opposite to i; walls take it and do not move.
template <bool friction>
void push(GrainSystem& system, const Candidate& candidate, const Meeting& meeting, Vec2 impulse, double tangential) {
  Push& on_i = system.pushes[static_cast<std::size_t>(candidate.i)];
  on_i.impulse -= impulse;
  if constexpr (friction) on_i.torque -= meeting.lever_i * tangential;
  if (candidate.j >= 0) {
    Push& on_j = system.pushes[static_cast<std::size_t>(candidate.j)];
    on_j.impulse += impulse;
    if constexpr (friction) on_j.torque -= meeting.lever_j * tangential;
  } else if (!system.options.verlet()) {
    system.lost.work_of_walls -= dot(impulse, system.walls[static_cast<std::size_t>(~candidate.j)].acting_velocity);
  }
}

void shift(GrainSystem& system, const Candidate& candidate, Vec2 moment) {
  system.moments[static_cast<std::size_t>(candidate.i)] += moment;
  if (candidate.j >= 0) system.moments[static_cast<std::size_t>(candidate.j)] -= moment;
}

/// What the pushes of the step before and gravity add in a step to the slip of a contact, its own tangential force
/// aside.
double gain_of_slip(const GrainSystem& system, const Candidate& candidate, const Meeting& meeting, double mass) {
  const auto i = static_cast<std::size_t>(candidate.i);
  const GrainBody& bi = system.bodies[i];
  Vec2 gain = -bi.inverse_mass * system.pushes_before[i].impulse;
  double turning = meeting.lever_i * bi.inverse_moment * system.pushes_before[i].torque;
  if (candidate.j >= 0) {
    const auto j = static_cast<std::size_t>(candidate.j);
    const GrainBody& bj = system.bodies[j];
    gain += bj.inverse_mass * system.pushes_before[j].impulse;
    turning += meeting.lever_j * bj.inverse_moment * system.pushes_before[j].torque;
  } else {
    gain -= system.dt() * system.scene.gravity;
  }
  return dot(gain, perpendicular(meeting.normal)) - turning - candidate.tangential_impulse / mass;
}

/// Tangential impulse on j over the step.
///
/// By the midpoint rule, with what other forces do to the slip over the step taken from the step before: a contact that
/// sticks under a steady load does not creep.
double slide(GrainSystem& system, Candidate& candidate, const Meeting& meeting, Vec2 relative, double normal_force) {
  const double velocity = slip_velocity(system, candidate, meeting, relative);
  const double dt = system.dt();
  const double mass = tangential_mass(system, candidate, meeting);
  const double gain = gain_of_slip(system, candidate, meeting, mass);
  const SlidingStep step =
      sliding_step_midpoint(candidate.sliding, candidate.stretch, velocity + 0.5 * gain, mass, normal_force, dt);
  candidate.stretch = step.stretch;
  system.lost.lost_slip += step.slip_loss;
  system.lost.lost_tangential_dashpot += step.dashpot_loss;
  return step.force * dt;
}

TouchPlace place_of(const Meeting& meeting, bool wall) {
  return {meeting.overlap, meeting.normal, meeting.lever_i * meeting.normal,
          wall ? Vec2{} : -meeting.lever_j * meeting.normal};
}

/// The normal turns in a drift, and levers change: to the first order, as in the loop over near pairs; with walls the
/// normal is known.
ContactDrift drift_of(const GrainSystem& system, const Candidate& candidate, const Meeting& meeting) {
  const double dt = system.dt();
  const GrainMotion& motion = system.motions[static_cast<std::size_t>(candidate.i)];
  if (candidate.j < 0) {
    const Vec2 relative = system.walls[static_cast<std::size_t>(~candidate.j)].passed_velocity - motion.velocity;
    const Vec2 before = candidate.steps > 0 ? candidate.normal : meeting.normal;
    const Vec2 normal = 0.5 * (before + meeting.normal);
    return {-dot(relative, normal), dot(relative, perpendicular(normal)) - motion.spin * meeting.lever_i,
            candidate.overlap};
  }
  const GrainMotion& other = system.motions[static_cast<std::size_t>(candidate.j)];
  const Vec2 relative = other.velocity - motion.velocity;
  const double along = dot(relative, perpendicular(meeting.normal)), closing = -dot(relative, meeting.normal);
  const double rims = motion.spin * meeting.lever_i + other.spin * meeting.lever_j;
  const double half = 0.5 * dt / (meeting.lever_i + meeting.lever_j);
  const double mean = closing + half * along * along;
  return {mean, along - rims - half * closing * (along + rims), meeting.overlap - mean * dt};
}

/// By a Verlet scheme, when the pairs that are near have had their turn.
template <class Law, bool friction>
void collide_candidates_by_verlet(GrainSystem& system) {
  for (Candidate& candidate : system.candidates) {
    const Meeting meeting = meeting_of(system, candidate);
    const TouchPlace place = place_of(meeting, candidate.j < 0);
    if (!(meeting.overlap > 0)) {
      if (candidate.touching) end_contact<Law>(system, candidate, place, drift_of(system, candidate, meeting));
      continue;
    }
    system.free_flight = false;
    if (!candidate.touching) ++system.counters.contacts;
    ++system.counters.evaluations;
    system.deepest = std::max(system.deepest, meeting.overlap);
    const Vec2 relative = relative_velocity(system, candidate);
    const auto others = [&] {
      const double mass = tangential_mass(system, candidate, meeting);
      return SlipByOthers{gain_of_slip(system, candidate, meeting, mass), mass};
    };
    const Vec2 impulse = step_contact<Law, friction>(system, candidate, place, -dot(relative, meeting.normal),
                                                     slip_velocity(system, candidate, meeting, relative),
                                                     drift_of(system, candidate, meeting), candidate.sliding, others);
    push<friction>(system, candidate, meeting, impulse, candidate.tangential_impulse);
  }
}

template <class Law, bool friction>
void collide_by(GrainSystem& system) {
  if constexpr (friction) system.pushes_before.swap(system.pushes);
  if (friction || !system.free_flight) std::fill(system.pushes.begin(), system.pushes.end(), Push{});
  constexpr bool map = Law::kind == LawKind::map;
  if (map && !system.free_flight) std::fill(system.moments.begin(), system.moments.end(), Vec2{});
  system.free_flight = true;
  if (system.near.active) {
    system.near.loop(system);
    if (friction && system.options.verlet()) {
      for (std::size_t i = 0; i < system.bodies.size(); ++i) turn_rims(system.pushes[i], system.bodies[i]);
    }
  }
  if constexpr (!map) {
    if (system.options.verlet()) return collide_candidates_by_verlet<Law, friction>(system);
  }
  const double dt = system.dt();
  const double length = system.length;
  const double per_length = 1 / length, per_speed = dt / length, unit_speed = length / dt;
  for (Candidate& candidate : system.candidates) {
    const Meeting meeting = meeting_of(system, candidate);
    if (!(meeting.overlap > 0)) {
      if (candidate.touching) let_go(system, candidate);
      continue;
    }
    if constexpr (map) {
      if (candidate.parted) let_go(system, candidate);
    }
    system.free_flight = false;
    if (!candidate.touching) ++system.counters.contacts;
    ++system.counters.evaluations;
    const Vec2 relative = relative_velocity(system, candidate);
    const double closing = -dot(relative, meeting.normal);
    const double depth = meeting.overlap * per_length;
    const double sigma = closing * per_speed;
    const ContactStep step = normal_step<Law>(candidate, depth, sigma);
    const double unit = candidate.reduced_mass * unit_speed;
    if constexpr (!map)
      system.lost.lost_dashpot += dashpot_heat<Law>(candidate, step, depth, closing, unit, unit_speed);
    candidate.touching = true;
    ++candidate.steps;
    candidate.mode = step.mode;
    candidate.overlap = meeting.overlap;
    system.deepest = std::max(system.deepest, meeting.overlap);
    candidate.closing = closing;
    candidate.normal = meeting.normal;
    candidate.impulse = -step.change * unit;
    Vec2 impulse = candidate.impulse * meeting.normal;
    if constexpr (map) {
      candidate.parted = depth + step.shift + sigma + step.change <= 0;
      system.lost.lost_restitution += step.loss * unit * unit_speed;
      if (step.shift != 0) shift(system, candidate, (step.shift * length * candidate.reduced_mass) * meeting.normal);
    }
    if constexpr (friction) {
      if (candidate.sliding.coefficient > 0) {
        candidate.tangential_impulse =
            slide(system, candidate, meeting, relative, std::max(candidate.impulse, 0.0) / dt);
        impulse += candidate.tangential_impulse * perpendicular(meeting.normal);
      }
    }
    push<friction>(system, candidate, meeting, impulse, candidate.tangential_impulse);
  }
}

}  // namespace

CollideFunction collide_function(NormalLaw law, bool friction) {
  return visit_law(law, [&]<class Law>(std::type_identity<Law>) -> CollideFunction {
    if constexpr (Law::kind == LawKind::simultaneous) {
      return nullptr;
    } else {
      return friction ? collide_by<Law, true> : collide_by<Law, false>;
    }
  });
}

void move_by_euler(GrainSystem& system) {
  const double dt = system.dt();
  const Vec2 fall = dt * system.scene.gravity;
  if (system.near.active) return move_pair_bodies(system);
  if (system.free_flight) {
    move_bodies(system, [&](std::size_t i) {
      GrainMotion motion = system.motions[i];
      motion.velocity += fall;
      motion.position += dt * motion.velocity;
      motion.angle += dt * motion.spin;
      return motion;
    });
    return;
  }
  move_bodies(system, [&](std::size_t i) {
    const GrainBody& body = system.bodies[i];
    const Push& push = system.pushes[i];
    GrainMotion motion = system.motions[i];
    motion.velocity += body.inverse_mass * push.impulse + fall;
    motion.spin += body.inverse_moment * push.torque;
    motion.position += dt * motion.velocity;
    if (!system.moments.empty()) motion.position += body.inverse_mass * system.moments[i];
    motion.angle += dt * motion.spin;
    return motion;
  });
}

void drift_of_verlet(GrainSystem& system) {
  const double dt = system.dt();
  const Vec2 fall = dt * system.scene.gravity;
  if (system.near.active) {
    move_bodies(system, [&](std::size_t i) {
      const GrainBody& body = system.bodies[i];
      GrainMotion motion = system.motions[i];
      const Vec2 gain = body.inverse_mass * system.pushes[i].impulse;
      const double turn = body.inverse_moment * system.pushes[i].torque;
      motion.velocity += 0.5 * (gain + fall);
      motion.spin += 0.5 * turn;
      motion.position += dt * motion.velocity;
      motion.angle += dt * motion.spin;
      system.near.bodies[i] = pair_body(body, motion, gain, turn);
      return motion;
    });
    return;
  }
  if (system.free_flight) {
    move_bodies(system, [&](std::size_t i) {
      GrainMotion motion = system.motions[i];
      motion.velocity += 0.5 * fall;
      motion.position += dt * motion.velocity;
      motion.angle += dt * motion.spin;
      return motion;
    });
    return;
  }
  move_bodies(system, [&](std::size_t i) {
    const GrainBody& body = system.bodies[i];
    GrainMotion motion = system.motions[i];
    motion.velocity += 0.5 * (body.inverse_mass * system.pushes[i].impulse + fall);
    motion.spin += 0.5 * body.inverse_moment * system.pushes[i].torque;
    motion.position += dt * motion.velocity;
    motion.angle += dt * motion.spin;
    return motion;
  });
}

void kick_of_verlet(GrainSystem& system) {
  const Vec2 fall = system.dt() * system.scene.gravity;
  if (system.free_flight) {
    for (GrainMotion& motion : system.motions) motion.velocity += 0.5 * fall;
    return give_touch_impulses(system);
  }
  for (std::size_t i = 0; i < system.motions.size(); ++i) {
    const GrainBody& body = system.bodies[i];
    system.motions[i].velocity += 0.5 * (body.inverse_mass * system.pushes[i].impulse + fall);
    system.motions[i].spin += 0.5 * body.inverse_moment * system.pushes[i].torque;
  }
  give_touch_impulses(system);
}

}  // namespace equidem
