// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/part_step.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/contact/laws/visit.hpp"
#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/contacts/force_step.hpp"
#include "equidem/grains/contacts/part_geometry.hpp"
#include "equidem/grains/contacts/verlet_contact.hpp"

namespace equidem {
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
  if (!contact.body_j)
    return system.walls.places[static_cast<std::size_t>(~contact.candidate.j)].acting_velocity - of_i;
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
    const GrainMotion& motion = system.bodies.motions[static_cast<std::size_t>(body)];
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
      push_wall(system, candidate.j,
                system.bodies.motions[static_cast<std::size_t>(candidate.i)].position + geometry.arm_i, impulse,
                system.walls.places[static_cast<std::size_t>(~candidate.j)].acting_velocity, sums.sums());
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
