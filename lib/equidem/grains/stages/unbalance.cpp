// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/unbalance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace equidem {

Unbalance unbalance_of(std::span<const Grain> grains, std::span<const GrainContact> contacts,
                       std::span<const GrainBond> bonds, Vec2 gravity) {
  std::vector<Vec2> forces(grains.size());
  for (std::size_t k = 0; k < grains.size(); ++k) forces[k] = grains[k].inertia.mass * gravity;
  double carried = 0;
  for (const GrainContact& contact : contacts) {
    const Vec2 on_j = contact.normal_force * contact.normal + contact.tangential_force * perpendicular(contact.normal);
    forces[static_cast<std::size_t>(contact.i)] -= on_j;
    if (contact.j >= 0) forces[static_cast<std::size_t>(contact.j)] += on_j;
    carried += norm(on_j);
  }
  for (const GrainBond& bond : bonds) {
    forces[bond.i] += forces[bond.j];
    forces[bond.j] = {};
  }
  double sum = 0, largest = 0;
  for (const Vec2 force : forces) {
    sum += norm(force);
    largest = std::max(largest, norm(force));
  }
  const double mean = contacts.empty() ? 0 : carried / static_cast<double>(contacts.size());
  if (!(mean > 0)) return {INFINITY, INFINITY};
  return {sum / static_cast<double>(grains.size() - bonds.size()) / mean, largest / mean};
}

}  // namespace equidem
