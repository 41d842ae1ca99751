// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/adjoint.hpp"

#include <cmath>
#include <utility>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

void check_count(const char* of_what, std::size_t given, std::size_t expected) {
  if (given == 0 || given == expected) return;
  bad_input(fmt::format("{} weights for {} {}", given, expected, of_what), "each has one", "Give as many, or none");
}

/// The sum over contacts of k (D a)(D b - w), differentiated. \param weights w, per contact; empty: 0
SpringAndPlaceDerivatives differentiated(const Assembly& assembly, const ContactSprings& springs,
                                         std::span<const DiscMotion> a, std::span<const DiscMotion> b,
                                         std::span<const ContactForce> weights) {
  const std::size_t contacts = assembly.contacts.size();
  SpringAndPlaceDerivatives found{{.by_kN = std::vector<double>(contacts),
                                   .by_kT = std::vector<double>(contacts),
                                   .by_kM = std::vector<double>(springs.bends() ? contacts : 0)},
                                  {}};
  if (assembly.contact_arms.empty() && !springs.prestressed()) found.by_position.resize(assembly.size());
  for (std::size_t c = 0; c < contacts; ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    const EndMotions ends_a{a[contact.i], a[contact.j]}, ends_b{b[contact.i], b[contact.j]};
    const ContactDeformation of_a = deformation(frame, ends_a.i, ends_a.j);
    ContactDeformation of_b = deformation(frame, ends_b.i, ends_b.j);
    if (!weights.empty()) of_b.normal -= weights[c].normal, of_b.tangential -= weights[c].tangential;
    found.by_kN[c] = of_a.normal * of_b.normal;
    found.by_kT[c] = of_a.tangential * of_b.tangential;
    if (!found.by_kM.empty()) found.by_kM[c] = (ends_a.j.theta - ends_a.i.theta) * (ends_b.j.theta - ends_b.i.theta);
    if (found.by_position.empty()) continue;
    const Vec2 change =
        energy_by_shape(frame, assembly.branch(contact), springs[c], {ends_a, ends_b, of_a, of_b}).by_branch;
    found.by_position[contact.i] -= change;
    found.by_position[contact.j] += change;
  }
  return found;
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

double SpringDerivatives::change_by(const ContactSprings& springs, std::size_t contact) const {
  double sum = springs[contact].kN * by_kN[contact];
  if (!by_kT.empty()) sum += springs[contact].kT * by_kT[contact];
  if (!by_kM.empty()) sum += springs.bending(contact) * by_kM[contact];
  return sum;
}

double SpringDerivatives::scatter(const ContactSprings& springs) const {
  double squares = 0;
  for (std::size_t c = 0; c < by_kN.size(); ++c) {
    const double change = change_by(springs, c);
    squares += change * change;
  }
  return std::sqrt(squares);
}

SpringAndPlaceDerivatives form_derivatives(const Assembly& assembly, const ContactSprings& springs,
                                           std::span<const DiscMotion> a, std::span<const DiscMotion> b) {
  for (const std::span<const DiscMotion>& motions : {a, b}) {
    if (motions.size() == assembly.size()) continue;
    bad_input(fmt::format("motions of {} discs for an assembly of {}", motions.size(), assembly.size()),
              "each disc has one", "Give as many");
  }
  return differentiated(assembly, springs, a, b, {});
}

MeasureDerivatives derivatives(EquilibriumSolver& solver, const Equilibrium& state, const Measure& measure) {
  const Assembly& assembly = solver.assembly();
  check_count("discs", measure.motions.size(), assembly.size());
  check_count("contacts", measure.forces.size(), assembly.contacts.size());
  Equilibrium adjoint = solver.solve_held(virtual_loads(solver, measure));
  MeasureDerivatives found{differentiated(assembly, solver.springs(), state.motions, adjoint.motions, measure.forces),
                           value_of(state, measure), std::move(adjoint.motions)};
  for (std::vector<double>* each : {&found.by_kN, &found.by_kT, &found.by_kM})
    for (double& value : *each) value = -value;
  for (Vec2& value : found.by_position) value = -value;
  return found;
}

}  // namespace equidem
