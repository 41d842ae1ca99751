// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <tuple>

#include "equidem/grains/contacts/part_geometry.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {

std::pair<double, double> GrainSimulation::Implementation::potential_and_kinetic() const {
  const bool behind = collide && system.options.integrator == GrainOptions::Integrator::semi_implicit_euler;
  return system.bodies.blocks.sum([&](std::size_t block) {
    double potential = 0, kinetic = 0;
    for (std::size_t i = system.bodies.blocks.begin(block); i < system.bodies.blocks.end(block); ++i) {
      const GrainMotion& motion = system.bodies.motions[i];
      const GrainBody& body = system.bodies.constants[i];
      Vec2 position = motion.position;
      if (system.cell.active) position += system.cell.now.shift(system.cell.crossed[i]);
      if (behind) position -= (0.5 * system.dt()) * motion.velocity;
      const double mass = 1 / body.inverse_mass;
      potential -= mass * dot(system.scene.gravity, position);
      kinetic += 0.5 * mass * dot(motion.velocity, motion.velocity);
      kinetic += 0.5 * motion.spin * motion.spin / body.inverse_moment;
    }
    return std::pair(potential, kinetic);
  });
}

std::pair<double, double> GrainSimulation::Implementation::elastic() const {
  // a force acts wherever bodies overlap; other laws count the spring from the first step of the contact on
  const bool holds_from_first_step = !gives_force(system.options.law);
  auto [normal, tangential] = elastic_of_near_pairs(system);
  const auto add = [&, &normal = normal, &tangential = tangential](const Candidate& candidate, double overlap) {
    tangential += 0.5 * candidate.sliding.stiffness * candidate.stretch * candidate.stretch;
    if (holds_from_first_step && (!candidate.touching || candidate.parted)) return;
    if (!(overlap > 0)) return;
    normal += system.law().energy(candidate.stiffness, overlap);
  };
  each_list_of_parts(system.contacts.near_parts, [&](const NearParts::List& list) {
    for (std::size_t p = 0; p < list.count; ++p) {
      auto [candidate, pair] = candidate_of(system, list, p);
      add(candidate, geometry_of_parts(system, candidate, pair).overlap);
    }
  });
  for (std::size_t c = 0; c < system.contacts.candidates.size(); ++c)
    add(system.contacts.candidates[c], overlap_of(system, c));
  return {normal, tangential};
}

EnergyLedger GrainSimulation::Implementation::energy() const {
  EnergyLedger ledger = system.lost;
  double potential = 0;
  std::tie(potential, ledger.kinetic) = potential_and_kinetic();
  std::tie(ledger.elastic_normal, ledger.elastic_tangential) = elastic();
  ledger.elastic_bond = elastic_of_bonds(system);
  ledger.potential = potential - potential_at_start;
  ledger.initial = energy_at_start;
  return ledger;
}

}  // namespace equidem
