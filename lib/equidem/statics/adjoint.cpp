// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/adjoint.hpp"

#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/shape_derivatives.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

void check_count(const char* what, std::size_t given, std::size_t expected) {
  if (given == 0 || given == expected) return;
  bad_input(fmt::format("{} weights for {} {}", given, expected, what), "each has one", "Give as many, or none");
}

/// g + D^T k w as loads on discs.
std::vector<DiscForce> virtual_loads(const EquilibriumSolver& solver, const Measure& measure) {
  const Assembly& assembly = solver.assembly();
  std::vector<DiscForce> loads = measure.motions;
  loads.resize(assembly.size());
  for (std::size_t c = 0; c < measure.forces.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    const ContactDeformation weights{measure.forces[c].normal, measure.forces[c].tangential};
    const ContactResponse<double> response = contact_response(solver.springs(), c, weights, 0.0, 0.0);
    const Vec2 pull = force_on_i(frame, response.force);
    loads[contact.i].force -= pull;
    loads[contact.j].force += pull;
    loads[contact.i].moment -= moment_on_i(frame, response.force) + response.moment_i;
    loads[contact.j].moment -= moment_on_j(frame, response.force) + response.moment_j;
  }
  if (!solver.effects().rotation) {
    for (DiscForce& load : loads) load.moment = 0;
  }
  return loads;
}

double value_of(const Equilibrium& state, const Measure& measure) {
  double sum = 0;
  for (std::size_t d = 0; d < measure.motions.size(); ++d)
    sum += dot(measure.motions[d].force, state.motions[d].u) + measure.motions[d].moment * state.motions[d].theta;
  for (std::size_t c = 0; c < measure.forces.size(); ++c)
    sum += measure.forces[c].normal * state.contact_forces[c].normal +
           measure.forces[c].tangential * state.contact_forces[c].tangential;
  return sum;
}

}  // namespace

MeasureDerivatives derivatives(EquilibriumSolver& solver, const Equilibrium& state, const Measure& measure) {
  const Assembly& assembly = solver.assembly();
  const ContactSprings& springs = solver.springs();
  const std::size_t contacts = assembly.contacts.size();
  check_count("discs", measure.motions.size(), assembly.size());
  check_count("contacts", measure.forces.size(), contacts);
  const Equilibrium adjoint = solver.solve_held(virtual_loads(solver, measure));
  MeasureDerivatives found{.value = value_of(state, measure),
                           .by_kN = std::vector<double>(contacts),
                           .by_kT = std::vector<double>(contacts),
                           .by_kM = std::vector<double>(solver.effects().bending ? contacts : 0),
                           .by_load = adjoint.motions,
                           .by_position = {}};
  if (assembly.contact_arms.empty() && !springs.prestressed()) found.by_position.resize(assembly.size());
  for (std::size_t c = 0; c < contacts; ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    const EndMotions u{state.motions[contact.i], state.motions[contact.j]};
    const EndMotions l{adjoint.motions[contact.i], adjoint.motions[contact.j]};
    const ContactDeformation of_u = deformation(frame, u.i, u.j);
    ContactDeformation of_l = deformation(frame, l.i, l.j);
    if (!measure.forces.empty())
      of_l.normal -= measure.forces[c].normal, of_l.tangential -= measure.forces[c].tangential;
    found.by_kN[c] = -of_l.normal * of_u.normal;
    found.by_kT[c] = -of_l.tangential * of_u.tangential;
    if (!found.by_kM.empty()) found.by_kM[c] = -(l.j.theta - l.i.theta) * (u.j.theta - u.i.theta);
    if (found.by_position.empty()) continue;
    const Vec2 change = energy_by_shape(frame, assembly.branch(contact), springs[c], {l, u, of_l, of_u}).by_branch;
    found.by_position[contact.i] += change;
    found.by_position[contact.j] -= change;
  }
  return found;
}

}  // namespace equidem
