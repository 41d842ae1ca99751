// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How far bonds are from where they rest, as callers see it.
#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/grains/contacts/bond_step.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {
namespace {

BondDrift drift_of(const GrainSystem& system, const TiedPair& bond) {
  const auto i = static_cast<std::size_t>(bond.i), j = static_cast<std::size_t>(bond.j);
  const BondMotion<double> motion = motion_of_bond(system, bond);
  const ContactDeformation drift = bond_deformation(bond.springs, motion);
  const double radii = system.bodies.constants[i].radius + system.bodies.constants[j].radius;
  const double roll = motion.theta_j - motion.theta_i;
  const auto [first, second] = std::minmax(system.bodies.grain_of[i], system.bodies.grain_of[j]);
  return {first, second, drift.normal / radii, drift.tangential / radii,
          first == system.bodies.grain_of[i] ? roll : -roll};
}

}  // namespace

std::vector<BondDrift> GrainSimulation::bond_drifts() const {
  std::vector<BondDrift> drifts;
  for (const TiedPair& bond : implementation_->system.bonds.tied)
    drifts.push_back(drift_of(implementation_->system, bond));
  std::sort(drifts.begin(), drifts.end(),
            [](const BondDrift& a, const BondDrift& b) { return std::pair(a.i, a.j) < std::pair(b.i, b.j); });
  return drifts;
}

BondReport GrainSimulation::bonds() const {
  const GrainSystem& system = implementation_->system;
  BondReport report;
  report.number = system.bonds.tied.size();
  report.step_limit = implementation_->bond_limit;
  const auto add = [&](BondReport::Drift& sum, double amount) {
    sum.largest = std::max(sum.largest, std::abs(amount));
    sum.mean += std::abs(amount) / static_cast<double>(report.number);
  };
  for (const TiedPair& bond : system.bonds.tied) {
    const BondDrift drift = drift_of(system, bond);
    add(report.distance, drift.distance);
    add(report.slip, drift.slip);
    add(report.roll, drift.roll);
  }
  return report;
}

}  // namespace equidem
