// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/force_step.hpp"

#include <cmath>

#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"

namespace equidem {

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
[[gnu::always_inline]] inline double tangential_impulse_of(const GrainSystem& system, Candidate& candidate,
                                                           const ContactGeometry& geometry, Vec2 relative,
                                                           double normal_impulse, EnergyLedger& lost) {
  const double velocity = slip_velocity(system, candidate, geometry, relative);
  const double inverse_mass = inverse_tangential_mass(system, candidate, geometry);
  const double gain = gain_of_slip(system, candidate, geometry, inverse_mass);
  const SlidingStep<double> step =
      slide(candidate.sliding, candidate.stretch, velocity + 0.5 * gain, inverse_mass, normal_impulse, system.dt());
  candidate.stretch = step.stretch;
  lost.lost_slip += step.slip_loss;
  lost.lost_tangential_dashpot += step.dashpot_loss;
  return -step.impulse;
}

/// The contacts of discs by a map.
template <class Law, bool friction>
void collide(GrainSystem& system, BlockSums& sums) {
  const double dt = system.dt();
  const double length = system.length;
  const double per_length = 1 / length, per_speed = dt / length, unit_speed = length / dt;
  EnergyLedger& lost = sums.lost;
  for (Candidate& candidate : system.contacts.candidates) {
    const ContactGeometry geometry = geometry_of(system, candidate);
    if (!(geometry.overlap > 0)) {
      if (candidate.touching) forget_contact(candidate, lost);
      continue;
    }
    if (candidate.parted) forget_contact(candidate, lost);
    if (!candidate.touching) ++sums.contacts;
    ++sums.evaluations;
    sums.deepest = std::max(sums.deepest, geometry.overlap);
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
        tangential = tangential_impulse_of(system, candidate, geometry, relative, candidate.impulse, lost);
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
    if constexpr (Law::facts.kind == LawKind::map) {
      return friction ? collide<Law, true> : collide<Law, false>;
    } else {
      return nullptr;
    }
  });
}

void move_by_euler(GrainSystem& system, std::size_t block) {
  if (system.contacts.has(Between::discs)) return move_pair_bodies(system, block);
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
  move_bodies(system, [&, near = system.contacts.has(Between::discs)](std::size_t i) {
    const GrainBody& body = system.bodies.constants[i];
    GrainMotion motion = system.bodies.motions[i];
    const Vec2 gain = body.inverse_mass * system.bodies.impulses[i].impulse;
    const double turn = body.inverse_moment * system.bodies.impulses[i].torque;
    motion.velocity += 0.5 * (gain + fall);
    motion.spin += 0.5 * turn;
    motion.position += dt * motion.velocity;
    motion.angle += dt * motion.spin;
    if (near) system.contacts.pairs.bodies[i] = pair_body(body, motion, gain, turn);
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

}  // namespace equidem
