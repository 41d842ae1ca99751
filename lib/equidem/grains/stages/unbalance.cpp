// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/unbalance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace equidem {
namespace {

/// For each grain the first one of its body.
std::vector<std::size_t> bodies_of(std::size_t grains, std::span<const GrainBond> bonds) {
  std::vector<std::size_t> first(grains);
  std::iota(first.begin(), first.end(), std::size_t{0});
  const auto first_of = [&](std::size_t grain) {
    while (first[grain] != grain) grain = first[grain] = first[first[grain]];
    return grain;
  };
  for (const GrainBond& bond : bonds) {
    if (bond.has_springs()) continue;
    const auto [low, high] = std::minmax({first_of(bond.i), first_of(bond.j)});
    first[high] = low;
  }
  for (std::size_t grain = 0; grain < grains; ++grain) first[grain] = first_of(grain);
  return first;
}

}  // namespace

Unbalance unbalance_of(const GrainSimulation& simulation, std::span<const GrainBond> bonds, Vec2 gravity) {
  const std::vector<Grain> grains = simulation.grains();
  const std::vector<std::size_t> body = bodies_of(grains.size(), bonds);
  std::vector<Vec2> forces(grains.size());
  for (std::size_t k = 0; k < grains.size(); ++k) forces[k] = grains[k].inertia.mass * gravity;
  double carried = 0, carriers = 0;
  for (const BodyContact& contact : simulation.body_contacts()) {
    const auto i = static_cast<std::size_t>(contact.i);
    if (contact.j >= 0 && body[i] == body[static_cast<std::size_t>(contact.j)]) continue;
    forces[i] += contact.force;
    if (contact.j >= 0) forces[static_cast<std::size_t>(contact.j)] -= contact.force;
    carried += norm(contact.force);
    carriers += 1;
  }
  double bodies = 0, sum = 0, largest = 0;
  for (std::size_t k = 0; k < grains.size(); ++k)
    if (body[k] != k) forces[body[k]] += forces[k];
  for (std::size_t k = 0; k < grains.size(); ++k) {
    if (body[k] != k) continue;
    const double force = norm(forces[k]);
    bodies += 1;
    sum += force;
    largest = std::max(largest, force);
  }
  const double mean = carriers > 0 ? carried / carriers : 0;
  if (!(mean > 0)) return {INFINITY, INFINITY};
  return {sum / bodies / mean, largest / mean};
}

}  // namespace equidem
