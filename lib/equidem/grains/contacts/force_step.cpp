// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/force_step.hpp"

#include <algorithm>

#include "equidem/contact/laws/visit.hpp"
#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"
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

/// Give an impulse to j, its opposite to i.
template <bool friction>
void push(std::vector<BodyImpulse>& impulses, const Candidate& candidate, const ContactGeometry& geometry, Vec2 impulse,
          double tangential) {
  BodyImpulse& on_i = impulses[static_cast<std::size_t>(candidate.i)];
  on_i.impulse -= impulse;
  if constexpr (friction) on_i.torque -= geometry.lever_i * tangential;
  if (candidate.j >= 0) {
    BodyImpulse& on_j = impulses[static_cast<std::size_t>(candidate.j)];
    on_j.impulse += impulse;
    if constexpr (friction) on_j.torque -= geometry.lever_j * tangential;
  }
}

void shift(GrainSystem& system, const Candidate& candidate, Vec2 moment) {
  system.bodies.moments[static_cast<std::size_t>(candidate.i)] += moment;
  if (candidate.j >= 0) system.bodies.moments[static_cast<std::size_t>(candidate.j)] -= moment;
}

/// Change of the slip of a contact in a step by the impulses of the previous step and gravity, its own tangential force
/// aside.
[[gnu::always_inline]] inline double gain_of_slip(const GrainSystem& system, const Candidate& candidate,
                                                  const ContactGeometry& geometry, double inverse_mass) {
  const auto i = static_cast<std::size_t>(candidate.i);
  const GrainBody& bi = system.bodies.constants[i];
  Vec2 gain = -bi.inverse_mass * system.bodies.impulses_before[i].impulse;
  double turning = geometry.lever_i * bi.inverse_moment * system.bodies.impulses_before[i].torque;
  if (candidate.j >= 0) {
    const auto j = static_cast<std::size_t>(candidate.j);
    const GrainBody& bj = system.bodies.constants[j];
    gain += bj.inverse_mass * system.bodies.impulses_before[j].impulse;
    turning += geometry.lever_j * bj.inverse_moment * system.bodies.impulses_before[j].torque;
  } else {
    gain -= system.dt() * system.scene.gravity;
  }
  return dot(gain, perpendicular(geometry.normal)) - turning - candidate.tangential_impulse * inverse_mass;
}

/// Tangential impulse on j over the step.
///
/// By the midpoint rule, with what other forces do to the slip over the step taken from the step before: a contact that
/// sticks under a steady load does not creep.
[[gnu::always_inline]] inline double slide(const GrainSystem& system, Candidate& candidate,
                                           const ContactGeometry& geometry, Vec2 relative, double normal_force,
                                           EnergyLedger& lost) {
  const double velocity = slip_velocity(system, candidate, geometry, relative);
  const double dt = system.dt();
  const double inverse_mass = inverse_tangential_mass(system, candidate, geometry);
  const double gain = gain_of_slip(system, candidate, geometry, inverse_mass);
  const SlidingStep step = sliding_step_midpoint(candidate.sliding, candidate.stretch, velocity + 0.5 * gain,
                                                 inverse_mass, normal_force, dt);
  candidate.stretch = step.stretch;
  lost.lost_slip += step.slip_loss;
  lost.lost_tangential_dashpot += step.dashpot_loss;
  return step.force * dt;
}

TouchPlace place_of(const ContactGeometry& geometry, bool wall) {
  return {geometry.overlap, geometry.normal, geometry.lever_i * geometry.normal,
          wall ? Vec2{} : -geometry.lever_j * geometry.normal};
}

/// The normal turns in a drift, and levers change: as in the loop over near pairs; with walls the normal is known.
ContactDrift drift_of(const GrainSystem& system, const Candidate& candidate, const ContactGeometry& geometry) {
  const double dt = system.dt();
  const GrainMotion& motion = system.bodies.motions[static_cast<std::size_t>(candidate.i)];
  if (candidate.j < 0) {
    const Vec2 relative = system.walls.places[static_cast<std::size_t>(~candidate.j)].passed_velocity - motion.velocity;
    const Vec2 before = candidate.steps > 0 ? candidate.normal : geometry.normal;
    const Vec2 normal = 0.5 * (before + geometry.normal);
    return {-dot(relative, normal), dot(relative, perpendicular(normal)) - motion.spin * geometry.lever_i,
            candidate.overlap};
  }
  const GrainMotion& other = system.bodies.motions[static_cast<std::size_t>(candidate.j)];
  const Vec2 relative = other.velocity - motion.velocity;
  const double along = dot(relative, perpendicular(geometry.normal)), closing = -dot(relative, geometry.normal);
  const double rims = motion.spin * geometry.lever_i + other.spin * geometry.lever_j;
  const double part = dt / (geometry.lever_i + geometry.lever_j);
  const double mean = closing + 0.5 * part * along * along;
  const double before = std::hypot(1 + part * closing, part * along);  // distance, in the present one
  return {mean, 0.5 * (along - rims + along / before - rims * before), geometry.overlap - mean * dt};
}

template <class Law, bool friction>
void collide_by_verlet(GrainSystem& system, std::size_t begin, std::size_t end, BlockSums& sums) {
  for (std::size_t c = begin; c < end; ++c) {
    Candidate& candidate = system.contacts.candidates[c];
    const ContactGeometry geometry = geometry_of(system, candidate);
    const TouchPlace place = place_of(geometry, candidate.j < 0);
    if (!(geometry.overlap > 0)) {
      if (candidate.touching)
        end_contact<Law>(system, candidate, place.arm_i, drift_of(system, candidate, geometry), sums.sums());
      continue;
    }
    count_contact(candidate, geometry.overlap, sums);
    const Vec2 relative = relative_velocity(system, candidate);
    const Vec2 impulse = step_contact<Law, friction>(
        system, candidate, place, -dot(relative, geometry.normal), slip_velocity(system, candidate, geometry, relative),
        drift_of(system, candidate, geometry), candidate.sliding, sums.sums());
    push<friction>(system.bodies.impulses, candidate, geometry, impulse, candidate.tangential_impulse);
  }
}

template <class Law, bool friction>
void collide(GrainSystem& system, std::size_t begin, std::size_t end, BlockSums& sums) {
  constexpr bool map = Law::kind == LawKind::map;
  if constexpr (!map) {
    if (system.options.verlet()) return collide_by_verlet<Law, friction>(system, begin, end, sums);
  }
  const double dt = system.dt();
  const double length = system.length;
  const double per_length = 1 / length, per_speed = dt / length, unit_speed = length / dt;
  EnergyLedger& lost = sums.lost;
  for (std::size_t c = begin; c < end; ++c) {
    Candidate& candidate = system.contacts.candidates[c];
    const ContactGeometry geometry = geometry_of(system, candidate);
    if (!(geometry.overlap > 0)) {
      if (candidate.touching) forget_contact(candidate, lost);
      continue;
    }
    if constexpr (map) {
      if (candidate.parted) forget_contact(candidate, lost);
    }
    count_contact(candidate, geometry.overlap, sums);
    const Vec2 relative = relative_velocity(system, candidate);
    const double closing = -dot(relative, geometry.normal);
    const double depth = geometry.overlap * per_length;
    const double sigma = closing * per_speed;
    const ContactStep step = normal_step<Law>(candidate, depth, sigma);
    const double unit = candidate.reduced_mass * unit_speed;
    if constexpr (!map) lost.lost_dashpot += dashpot_heat<Law>(candidate, step, depth, closing, unit, unit_speed);
    candidate.touching = true;
    ++candidate.steps;
    candidate.mode = step.mode;
    candidate.overlap = geometry.overlap;
    candidate.closing = closing;
    candidate.normal = geometry.normal;
    candidate.impulse = -step.change * unit;
    Vec2 impulse = candidate.impulse * geometry.normal;
    if constexpr (map) {
      candidate.parted = depth + step.shift + sigma + step.change <= 0;
      lost.lost_restitution += step.loss * unit * unit_speed;
      if (step.shift != 0) shift(system, candidate, (step.shift * length * candidate.reduced_mass) * geometry.normal);
    }
    double tangential = 0;  // also where the friction of an earlier stage left one
    if constexpr (friction) {
      if (candidate.sliding.coefficient > 0)
        tangential = slide(system, candidate, geometry, relative, std::max(candidate.impulse, 0.0) / dt, lost);
      impulse += tangential * perpendicular(geometry.normal);
    }
    candidate.tangential_impulse = tangential;
    push<friction>(system.bodies.impulses, candidate, geometry, impulse, candidate.tangential_impulse);
    if (candidate.j < 0)
      push_wall(
          system, candidate.j,
          system.bodies.motions[static_cast<std::size_t>(candidate.i)].position + geometry.lever_i * geometry.normal,
          impulse, system.walls.places[static_cast<std::size_t>(~candidate.j)].acting_velocity, sums.sums());
  }
}

}  // namespace

CandidateLoop candidate_loop(NormalLaw law, bool friction) {
  return visit_law(law, [&]<class Law>(std::type_identity<Law>) -> CandidateLoop {
    if constexpr (Law::kind == LawKind::simultaneous) {
      return nullptr;
    } else {
      return friction ? collide<Law, true> : collide<Law, false>;
    }
  });
}

void move_by_euler(GrainSystem& system, std::size_t block, bool free_flight) {
  const double dt = system.dt();
  const Vec2 fall = dt * system.scene.gravity;
  if (system.contacts.near.active) {
    move_pair_bodies(system, block);
  } else if (free_flight) {
    system.bodies.ways[block] = move_block(system, block, [&](std::size_t i) {
      GrainMotion motion = system.bodies.motions[i];
      motion.velocity += fall;
      motion.position += dt * motion.velocity;
      motion.angle += dt * motion.spin;
      return motion;
    });
  } else {
    system.bodies.ways[block] = move_block(system, block, [&](std::size_t i) {
      const GrainBody& body = system.bodies.constants[i];
      const BodyImpulse& push = system.bodies.impulses[i];
      GrainMotion motion = system.bodies.motions[i];
      motion.velocity += body.inverse_mass * push.impulse + fall;
      motion.spin += body.inverse_moment * push.torque;
      motion.position += dt * motion.velocity;
      if (!system.bodies.moments.empty()) motion.position += body.inverse_mass * system.bodies.moments[i];
      motion.angle += dt * motion.spin;
      return motion;
    });
  }
}

void drift_of_verlet(GrainSystem& system) {
  const double dt = system.dt();
  const Vec2 fall = dt * system.scene.gravity;
  if (system.contacts.near.active) {
    move_bodies(system, [&](std::size_t i) {
      const GrainBody& body = system.bodies.constants[i];
      GrainMotion motion = system.bodies.motions[i];
      const Vec2 gain = body.inverse_mass * system.bodies.impulses[i].impulse;
      const double turn = body.inverse_moment * system.bodies.impulses[i].torque;
      motion.velocity += 0.5 * (gain + fall);
      motion.spin += 0.5 * turn;
      motion.position += dt * motion.velocity;
      motion.angle += dt * motion.spin;
      system.contacts.near.bodies[i] = pair_body(body, motion, gain, turn);
      return motion;
    });
    return;
  }
  if (system.free_flight) {
    move_bodies(system, [&](std::size_t i) {
      GrainMotion motion = system.bodies.motions[i];
      motion.velocity += 0.5 * fall;
      motion.position += dt * motion.velocity;
      motion.angle += dt * motion.spin;
      return motion;
    });
    return;
  }
  move_bodies(system, [&](std::size_t i) {
    const GrainBody& body = system.bodies.constants[i];
    GrainMotion motion = system.bodies.motions[i];
    motion.velocity += 0.5 * (body.inverse_mass * system.bodies.impulses[i].impulse + fall);
    motion.spin += 0.5 * body.inverse_moment * system.bodies.impulses[i].torque;
    motion.position += dt * motion.velocity;
    motion.angle += dt * motion.spin;
    return motion;
  });
}

void kick_of_verlet(GrainSystem& system, std::size_t block, bool free_flight) {
  const Vec2 fall = system.dt() * system.scene.gravity;
  for (std::size_t i = system.bodies.blocks.begin(block); i < system.bodies.blocks.end(block); ++i) {
    GrainMotion& motion = system.bodies.motions[i];
    if (free_flight) {
      motion.velocity += 0.5 * fall;
      continue;
    }
    const GrainBody& body = system.bodies.constants[i];
    motion.velocity += 0.5 * (body.inverse_mass * system.bodies.impulses[i].impulse + fall);
    motion.spin += 0.5 * body.inverse_moment * system.bodies.impulses[i].torque;
  }
}

}  // namespace equidem
