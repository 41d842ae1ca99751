// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <tuple>

#include "equidem/grains/contacts/part_geometry.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {

double GrainSimulation::Implementation::potential() const {
  const bool behind = collide && system.options.integrator == GrainOptions::Integrator::semi_implicit_euler;
  double sum = 0;
  for (std::size_t i = 0; i < system.bodies.motions.size(); ++i) {
    Vec2 position = system.bodies.motions[i].position;
    if (system.cell.active) position += system.cell.now.shift(system.cell.crossed[i]);
    if (behind) position -= (0.5 * system.dt()) * system.bodies.motions[i].velocity;
    sum -= dot(system.scene.gravity, position) / system.bodies.constants[i].inverse_mass;
  }
  return sum;
}

double GrainSimulation::Implementation::kinetic() const {
  double sum = 0;
  for (std::size_t i = 0; i < system.bodies.motions.size(); ++i) {
    const GrainMotion& motion = system.bodies.motions[i];
    sum += 0.5 * dot(motion.velocity, motion.velocity) / system.bodies.constants[i].inverse_mass;
    sum += 0.5 * motion.spin * motion.spin / system.bodies.constants[i].inverse_moment;
  }
  return sum;
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
  ledger.kinetic = kinetic();
  std::tie(ledger.elastic_normal, ledger.elastic_tangential) = elastic();
  ledger.elastic_bond = elastic_of_bonds(system);
  ledger.potential = potential() - potential_at_start;
  ledger.initial = energy_at_start;
  return ledger;
}

}  // namespace equidem
