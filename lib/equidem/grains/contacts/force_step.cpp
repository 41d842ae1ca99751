// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One contact in a step of the Verlet schemes: its impulse, and its losses in the drift before.
///
/// The kick J of an instant does work half with the velocity of the drift before it and half with that of the drift
/// after it: the loss of a contact in a drift is 0.5 (J_before + J_now) times its speed, less the energy stored in its
/// springs. No prediction is needed. A contact that begins or ends within a drift has one of the two kicks: the ledger
/// is of the first order of the step there.
#include "equidem/grains/contacts/force_step.hpp"

#include <cmath>

#include "equidem/contact/laws/visit.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"

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
  return candidate.j >= 0 ? Vec2{} : system.walls.places[~candidate.j].passed_velocity;
}

/// Count what the body gave to a wall in the drift before: half of each of the kicks at its ends.
/// \param kicks sum of both, N s
inline void push_wall_in_drift(const GrainSystem& system, const Candidate& candidate, Vec2 arm, Vec2 kicks,
                               ContactSums sums) {
  const Vec2 point = system.bodies.motions[candidate.i].position + arm;
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

namespace {

/// Give an impulse to j, its opposite to i.
template <bool friction>
void push(std::vector<BodyImpulse>& impulses, const Candidate& candidate, const ContactGeometry& geometry, Vec2 impulse,
          double tangential) {
  BodyImpulse& on_i = impulses[candidate.i];
  on_i.impulse -= impulse;
  if constexpr (friction) on_i.torque -= geometry.lever_i * tangential;
  if (candidate.j >= 0) {
    BodyImpulse& on_j = impulses[candidate.j];
    on_j.impulse += impulse;
    if constexpr (friction) on_j.torque -= geometry.lever_j * tangential;
  }
}

void shift(GrainSystem& system, const Candidate& candidate, Vec2 moment) {
  system.bodies.moments[candidate.i] += moment;
  if (candidate.j >= 0) system.bodies.moments[candidate.j] -= moment;
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

TouchPlace place_of(const ContactGeometry& geometry) {
  return {geometry.overlap, geometry.normal, geometry.lever_i * geometry.normal, {}};
}

/// The drift of a disc along a wall.
ContactDrift drift_of(const GrainSystem& system, const Candidate& candidate, const ContactGeometry& geometry) {
  const GrainMotion& motion = system.bodies.motions[candidate.i];
  const Vec2 relative = passed_velocity(system, candidate) - motion.velocity;
  const Vec2 before = candidate.steps > 0 ? candidate.normal : geometry.normal;
  const Vec2 normal = 0.5 * (before + geometry.normal);
  return {-dot(relative, normal), dot(relative, perpendicular(normal)) - motion.spin * geometry.lever_i,
          candidate.overlap};
}

/// The contacts of discs with walls in Verlet schemes.
template <class Law, bool friction>
void collide_by_verlet(GrainSystem& system, std::size_t begin, std::size_t end, BlockSums& sums) {
  for (std::size_t c = begin; c < end; ++c) {
    Candidate& candidate = system.contacts.candidates[c];
    const ContactGeometry geometry = geometry_of(system, candidate);
    const TouchPlace place = place_of(geometry);
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

/// The contacts of discs by a map.
template <class Law, bool friction>
void collide(GrainSystem& system, std::size_t begin, std::size_t end, BlockSums& sums) {
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
    if (candidate.parted) forget_contact(candidate, lost);
    count_contact(candidate, geometry.overlap, sums);
    const Vec2 relative = relative_velocity(system, candidate);
    const double closing = -dot(relative, geometry.normal);
    const double depth = geometry.overlap * per_length;
    const double sigma = closing * per_speed;
    const ContactStep step = Law::step(depth, sigma, candidate.a, candidate.dissipation, !candidate.touching);
    const double unit = candidate.reduced_mass * unit_speed;
    candidate.touching = true;
    ++candidate.steps;
    candidate.mode = step.mode;
    candidate.overlap = geometry.overlap;
    candidate.closing = closing;
    candidate.normal = geometry.normal;
    candidate.impulse = -step.change * unit;
    Vec2 impulse = candidate.impulse * geometry.normal;
    candidate.parted = depth + step.shift + sigma + step.change <= 0;
    lost.lost_restitution += step.loss * unit * unit_speed;
    if (step.shift != 0) shift(system, candidate, (step.shift * length * candidate.reduced_mass) * geometry.normal);
    double tangential = 0;  // also where the friction of an earlier stage left one
    if constexpr (friction) {
      if (candidate.sliding.coefficient > 0)
        tangential = slide(system, candidate, geometry, relative, std::max(candidate.impulse, 0.0) / dt, lost);
      impulse += tangential * perpendicular(geometry.normal);
    }
    candidate.tangential_impulse = tangential;
    push<friction>(system.bodies.impulses, candidate, geometry, impulse, candidate.tangential_impulse);
    if (candidate.j < 0)
      push_wall(system, candidate.j, system.bodies.motions[candidate.i].position + geometry.lever_i * geometry.normal,
                impulse, system.walls.places[~candidate.j].acting_velocity, sums.sums());
  }
}

}  // namespace

CandidateLoop candidate_loop(NormalLaw law, bool friction) {
  return visit_law(law, [&]<class Law>(std::type_identity<Law>) -> CandidateLoop {
    if constexpr (Law::kind == LawKind::simultaneous) {
      return nullptr;
    } else if constexpr (Law::kind == LawKind::force) {
      return friction ? collide_by_verlet<Law, true> : collide_by_verlet<Law, false>;
    } else {
      return friction ? collide<Law, true> : collide<Law, false>;
    }
  });
}

void move_by_euler(GrainSystem& system, std::size_t block) {
  if (system.contacts.near.active) return move_pair_bodies(system, block);
  const double dt = system.dt();
  const Vec2 fall = dt * system.scene.gravity;
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

void drift_of_verlet(GrainSystem& system) {
  const double dt = system.dt();
  const Vec2 fall = dt * system.scene.gravity;
  move_bodies(system, [&, near = system.contacts.near.active](std::size_t i) {
    const GrainBody& body = system.bodies.constants[i];
    GrainMotion motion = system.bodies.motions[i];
    const Vec2 gain = body.inverse_mass * system.bodies.impulses[i].impulse;
    const double turn = body.inverse_moment * system.bodies.impulses[i].torque;
    motion.velocity += 0.5 * (gain + fall);
    motion.spin += 0.5 * turn;
    motion.position += dt * motion.velocity;
    motion.angle += dt * motion.spin;
    if (near) system.contacts.near.bodies[i] = pair_body(body, motion, gain, turn);
    return motion;
  });
}

void kick_of_verlet(GrainSystem& system, std::size_t block) {
  const Vec2 fall = system.dt() * system.scene.gravity;
  for (std::size_t i = system.bodies.blocks.begin(block); i < system.bodies.blocks.end(block); ++i) {
    GrainMotion& motion = system.bodies.motions[i];
    const GrainBody& body = system.bodies.constants[i];
    motion.velocity += 0.5 * (body.inverse_mass * system.bodies.impulses[i].impulse + fall);
    motion.spin += 0.5 * body.inverse_moment * system.bodies.impulses[i].torque;
  }
}

namespace {

// Functions of a contact are inlined, or its numbers would go through memory: a twentieth of the time.

/// A contact with its two bodies; a wall has none.
struct PartContact {
  const Candidate& candidate;
  const PartGeometry& geometry;
  const GrainBody& body_i;
  const GrainBody* body_j;

  PartContact(const GrainSystem& system, const Candidate& of, const PartGeometry& met)
      : candidate(of),
        geometry(met),
        body_i(system.bodies.constants[i()]),
        body_j(of.j >= 0 ? &system.bodies.constants[j()] : nullptr) {}

  [[nodiscard]] std::size_t i() const { return static_cast<std::size_t>(candidate.i); }
  [[nodiscard]] std::size_t j() const { return static_cast<std::size_t>(candidate.j); }
  [[nodiscard]] Vec2 tangent() const { return perpendicular(geometry.normal); }
};

/// Velocity of the contact point of j, or of the wall, relative to that of i.
[[gnu::always_inline]] inline Vec2 relative_velocity(const GrainSystem& system, const PartContact& contact) {
  const GrainMotion& motion = system.bodies.motions[contact.i()];
  const Vec2 of_i = motion.velocity + motion.spin * perpendicular(contact.geometry.arm_i);
  if (!contact.body_j) return system.walls.places[~contact.candidate.j].acting_velocity - of_i;
  const GrainMotion& other = system.bodies.motions[contact.j()];
  return other.velocity + other.spin * perpendicular(contact.geometry.arm_j) - of_i;
}

/// 1/m_i + 1/m_j + (arm_i x s)²/I_i + (arm_j x s)²/I_j, 1/kg.
/// \param share of what the arms lack to the surface that is added
[[gnu::always_inline]] inline double inverse_tangential_mass(const PartContact& contact, double share) {
  const PartGeometry& geometry = contact.geometry;
  const double lever_i = cross(geometry.arm_i, contact.tangent()) + share * geometry.sunk_i;
  double inverse = contact.body_i.inverse_mass + lever_i * lever_i * contact.body_i.inverse_moment;
  if (contact.body_j) {
    const double lever_j = cross(geometry.arm_j, contact.tangent()) - share * geometry.sunk_j;
    inverse += contact.body_j->inverse_mass + lever_j * lever_j * contact.body_j->inverse_moment;
  }
  return inverse;
}

/// (1/m' of the contact points along the normal)/(1/m of the centres); see part_candidate_loop.
[[gnu::always_inline]] inline double eccentricity(const PartContact& contact) {
  const PartGeometry& geometry = contact.geometry;
  const double lever_i = cross(geometry.arm_i, geometry.normal);
  double inverse = lever_i * lever_i * contact.body_i.inverse_moment;
  if (contact.body_j) {
    const double lever_j = cross(geometry.arm_j, geometry.normal);
    inverse += lever_j * lever_j * contact.body_j->inverse_moment;
  }
  return 1 + contact.candidate.reduced_mass * inverse;
}

/// Change of the slip of a contact in a step by the impulses of the previous step and gravity, its own tangential force
/// aside.
[[gnu::always_inline]] inline double gain_of_slip(const GrainSystem& system, const PartContact& contact,
                                                  double inverse_mass) {
  const PartGeometry& geometry = contact.geometry;
  const auto gain_of = [&](const GrainBody& body, const BodyImpulse& push, Vec2 arm) {
    return body.inverse_mass * push.impulse + (body.inverse_moment * push.torque) * perpendicular(arm);
  };
  Vec2 gain = -gain_of(contact.body_i, system.bodies.impulses_before[contact.i()], geometry.arm_i);
  if (contact.body_j) {
    gain += gain_of(*contact.body_j, system.bodies.impulses_before[contact.j()], geometry.arm_j);
  } else {
    gain -= system.dt() * system.scene.gravity;
  }
  return dot(gain, contact.tangent()) - contact.candidate.tangential_impulse * inverse_mass;
}

[[gnu::always_inline]] inline Sliding sliding_of(const Candidate& candidate, const PartPair& pair,
                                                 const PartContact& contact) {
  Sliding law = candidate.sliding;
  if (pair.tangential_damping > 0)
    law.dashpot = pair.tangential_damping * std::sqrt(1 / inverse_tangential_mass(contact, 1));
  return law;
}

/// Tangential impulse on j over the step, as of discs (force_step.cpp).
[[gnu::always_inline]] inline double slide(const GrainSystem& system, Candidate& candidate, const PartPair& pair,
                                           const PartContact& contact, double velocity, double normal_force,
                                           EnergyLedger& lost) {
  const double dt = system.dt();
  const double inverse_mass = inverse_tangential_mass(contact, 0);
  const double gain = gain_of_slip(system, contact, inverse_mass);
  const SlidingStep step = sliding_step_midpoint(sliding_of(candidate, pair, contact), candidate.stretch,
                                                 velocity + 0.5 * gain, inverse_mass, normal_force, dt);
  candidate.stretch = step.stretch;
  lost.lost_slip += step.slip_loss;
  lost.lost_tangential_dashpot += step.dashpot_loss;
  return step.force * dt;
}

TouchPlace place_before(const Candidate& candidate, const PartPair& pair) {
  return {candidate.overlap, candidate.normal, pair.arm_i, pair.arm_j};
}

/// By the places at both ends of the drift.
ContactDrift drift_of(const GrainSystem& system, const Candidate& candidate, const TouchPlace& now,
                      const TouchPlace& before) {
  const auto at = [&](std::int32_t body, Vec2 arm) {
    const GrainMotion& motion = system.bodies.motions[body];
    return motion.velocity + motion.spin * perpendicular(arm);
  };
  const auto relative = [&](const TouchPlace& place) {
    return (candidate.j >= 0 ? at(candidate.j, place.arm_j) : passed_velocity(system, candidate)) -
           at(candidate.i, place.arm_i);
  };
  const Vec2 here = relative(now), there = relative(before);
  return {-0.5 * (dot(here, now.normal) + dot(there, before.normal)),
          0.5 * (dot(here, perpendicular(now.normal)) + dot(there, perpendicular(before.normal))), before.overlap};
}

/// Give an impulse to j, its opposite to i.
[[gnu::always_inline]] inline void push(std::vector<BodyImpulse>& impulses, const PartContact& contact, Vec2 impulse) {
  BodyImpulse& on_i = impulses[contact.i()];
  on_i.impulse -= impulse;
  on_i.torque -= cross(contact.geometry.arm_i, impulse);
  if (contact.body_j) {
    BodyImpulse& on_j = impulses[contact.j()];
    on_j.impulse += impulse;
    on_j.torque += cross(contact.geometry.arm_j, impulse);
  }
}

template <class Law, bool friction>
void collide_parts(GrainSystem& system, std::size_t begin, std::size_t end, BlockSums& sums) {
  const bool verlet = system.options.verlet();
  const double dt = system.dt();
  const double length = system.length;
  const double per_length = 1 / length, per_speed = dt / length, unit_speed = length / dt;
  for (std::size_t c = begin; c < end; ++c) {
    Candidate& candidate = system.contacts.candidates[c];
    PartPair& pair = system.contacts.part_pairs[c];
    const PartGeometry geometry = geometry_of_parts(system, candidate, pair);
    if (!(geometry.overlap > 0)) {
      if (!candidate.touching) continue;
      if (verlet) {
        const TouchPlace place = place_before(candidate, pair);
        end_contact<Law>(system, candidate, place.arm_i, drift_of(system, candidate, place, place), sums.sums());
      } else {
        forget_contact(candidate, sums.lost);
      }
      continue;
    }
    count_contact(candidate, geometry.overlap, sums);
    const PartContact contact(system, candidate, geometry);
    const Vec2 relative = relative_velocity(system, contact);
    if (verlet) {
      const TouchPlace place{geometry.overlap, geometry.normal, geometry.arm_i, geometry.arm_j};
      const ContactDrift drift =
          drift_of(system, candidate, place, candidate.steps > 0 ? place_before(candidate, pair) : place);
      pair.arm_i = geometry.arm_i;
      pair.arm_j = geometry.arm_j;
      push(system.bodies.impulses, contact,
           step_contact<Law, friction>(system, candidate, place, -dot(relative, geometry.normal),
                                       dot(relative, contact.tangent()), drift, sliding_of(candidate, pair, contact),
                                       sums.sums()));
      continue;
    }
    const double closing = -dot(relative, geometry.normal);
    const double depth = geometry.overlap * per_length, sigma = closing * per_speed;
    const ContactStep step = force_step<Law>(depth, sigma, candidate.a, candidate.dissipation, candidate.attraction);
    const double unit = candidate.reduced_mass * unit_speed;
    sums.lost.lost_dashpot +=
        dashpot_heat<Law>(candidate, step, depth, closing, unit, unit_speed, eccentricity(contact));
    candidate.touching = true;
    ++candidate.steps;
    candidate.overlap = geometry.overlap;
    candidate.closing = closing;
    candidate.normal = geometry.normal;
    pair.arm_i = geometry.arm_i;
    pair.arm_j = geometry.arm_j;
    candidate.impulse = -step.change * unit;
    Vec2 impulse = candidate.impulse * geometry.normal;
    double tangential = 0;  // as of discs
    if constexpr (friction) {
      if (candidate.sliding.coefficient > 0)
        tangential = slide(system, candidate, pair, contact, dot(relative, contact.tangent()),
                           std::max(candidate.impulse, 0.0) / dt, sums.lost);
      impulse += tangential * contact.tangent();
    }
    candidate.tangential_impulse = tangential;
    push(system.bodies.impulses, contact, impulse);
    if (candidate.j < 0)
      push_wall(system, candidate.j, system.bodies.motions[candidate.i].position + geometry.arm_i, impulse,
                system.walls.places[~candidate.j].acting_velocity, sums.sums());
  }
}

}  // namespace

CandidateLoop part_candidate_loop(NormalLaw law, bool friction) {
  return visit_law(law, [&]<class Law>(std::type_identity<Law>) -> CandidateLoop {
    if constexpr (Law::kind == LawKind::force) {
      return friction ? collide_parts<Law, true> : collide_parts<Law, false>;
    } else {
      return nullptr;
    }
  });
}

}  // namespace equidem
