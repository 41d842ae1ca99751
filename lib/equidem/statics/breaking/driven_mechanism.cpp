// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Mechanisms that loads drive, found with a factor that is updated (UpdatedState::driven_mechanism).
#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/statics/breaking/updated_state.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {
namespace {

/// x over its largest component. \return false where that is no positive number
bool scale_to_one(std::vector<double>& x) {
  double largest = 0;
  for (const double value : x) largest = std::max(largest, std::abs(value));
  if (!(largest > 0 && std::isfinite(largest))) return false;
  for (double& value : x) value /= largest;
  return true;
}

/// Whether loads, per component, work on a motion of the largest component 1.
bool works(const std::vector<double>& force, const std::vector<double>& motion) {
  constexpr double negligible = 1e-8;  // over the size of the terms: what rounding leaves where loads balance
  double work = 0, size = 0;
  for (std::size_t k = 0; k < force.size(); ++k) work += motion[k] * force[k], size += std::abs(force[k]);
  return std::abs(work) > negligible * size;
}

}  // namespace

// With K + s e e^T, which holds one component of a mechanism, K v + s e e.v = e has the mechanism for a solution. Where
// round-off has left a pivot in place of it, solutions turn to it: their other parts are smaller by that pivot over the
// next stiffness, each time. What the factor is wrong by is then corrected with the forces of the contacts.
std::vector<DiscMotion> UpdatedState::driven_mechanism(std::int64_t component) const {
  constexpr int most_solutions = 3, most_corrections = 2;
  const auto free = [&](std::size_t k) { return unknowns.held[k] == DegreesOfFreedom::free; };
  std::vector<double> x(components()), change(components());
  if (component >= 0) x[static_cast<std::size_t>(component)] = 1;
  for (std::size_t k = 0; component < 0 && k < cases[0].force.size(); ++k) x[k] = free(k) ? cases[0].force[k] : 0;
  for (int step = 0; step < (component >= 0 ? 1 : most_solutions); ++step) {
    if (!scale_to_one(x)) return {};
    factor->solve(x, 1);
  }
  for (int step = 0;; ++step) {
    if (!scale_to_one(x)) return {};
    for (const RightHandSide& given : cases) {
      if (!works(given.force, x)) return {};
    }
    std::vector<DiscMotion> motions = disc_motions(unknowns, x);
    if (softness(assembly, springs, motions) < softness_of_mechanisms) return motions;
    if (step == most_corrections) return {};
    std::vector<ContactForce> forces;
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      const Contact& contact = assembly.contacts[c];
      forces.push_back(linear_spring_force(
          springs[c], equidem::deformation(frame_of(assembly, c), motions[contact.i], motions[contact.j])));
    }
    internal_force(assembly, graph, unknowns, forces, change);
    for (std::size_t k = 0; k < change.size(); ++k) change[k] = free(k) ? change[k] : 0;
    factor->solve(change, 1);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] -= change[k];
  }
}

}  // namespace equidem
