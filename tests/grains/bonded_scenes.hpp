// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Small scenes of bonded discs.
#pragma once

#include <array>
#include <vector>

#include "equidem/grains/contacts/bonds.hpp"

#include "grains/scenes.hpp"

namespace equidem::test {

/// Deformation of the bonds of a scene since the start, over the sum of the radii; of discs that have not gone round a
/// periodic cell.
struct BondDrifts {
  struct Drift {
    double largest = 0, mean = 0;  ///< of the absolute values over all bonds
  };
  Drift distance, slip, roll;  ///< roll: rad
};

inline BondDrifts drifts_of(const GrainScene& scene, const GrainSimulation& simulation) {
  BondDrifts drifts;
  const std::vector<Grain> now = simulation.grains();
  const auto add = [&](BondDrifts::Drift& sum, double amount) {
    sum.largest = std::max(sum.largest, std::abs(amount));
    sum.mean += std::abs(amount) / static_cast<double>(scene.bonds.size());
  };
  for (const GrainBond& bond : scene.bonds) {
    const Grain &i = scene.grains[bond.i], &j = scene.grains[bond.j];
    const BondRest rest = bond.rest ? *bond.rest : rest_of(scene, bond.i, bond.j);
    const double radii = i.radius + j.radius, length = norm(rest.branch), lever = length * i.radius / radii;
    const Vec2 way = now[bond.j].position - now[bond.i].position - rest.branch;
    const BondMotion<double> motion{way.x, way.y, now[bond.i].angle - rest.angle_i, now[bond.j].angle - rest.angle_j};
    const ContactDeformation drift = bond_deformation(FiniteBond{rest.branch, lever, length - lever, {}, 0}, motion);
    add(drifts.distance, drift.normal / radii);
    add(drifts.slip, drift.tangential / radii);
    add(drifts.roll, motion.theta_j - motion.theta_i);
  }
  return drifts;
}

/// Those that know bonds.
inline const std::vector<Stepping> bonding_steppings{all_steppings[0], all_steppings[1], all_steppings[2],
                                                     all_steppings[5]};

/// Every dashpot and spring.
inline constexpr GrainBond all_of_a_bond{
    .normal_dashpot = 3, .tangential_dashpot = 2, .rolling_dashpot = 0.1, .normal_spring = 5, .tangential_spring = 4};

/// Two unequal discs that just touch, the first at the origin, the other on the x axis.
inline GrainScene pair_scene(NormalLaw law, const GrainBond& bond) {
  GrainScene scene = scene_of({ball({0, 0}, 0.5, {}, 1), ball({0.8, 0}, 0.3, {}, 0.36)}, {}, one_second(law, 0.5));
  scene.bonds = {bond};
  return scene;
}

/// A crooked chain of discs that move at random, tied one to the next, without gravity and walls.
inline GrainScene chain_scene(NormalLaw law, std::size_t discs, const GrainBond& like) {
  Random random(discs);
  std::vector<Grain> grains;
  Vec2 place;
  for (std::size_t k = 0; k < discs; ++k) {
    const double radius = random.uniform(0.3, 0.5);
    Grain grain = ball(place, radius, {random.uniform(-1, 1), random.uniform(-1, 1)}, 4 * radius * radius);
    grain.spin = random.uniform(-1, 1);
    grains.push_back(grain);
    place += Vec2{1, k % 2 == 0 ? 0.3 : -0.5};
  }
  GrainScene scene = scene_of(std::move(grains), {}, one_second(law, 0.8));
  for (std::size_t k = 0; k + 1 < discs; ++k) {
    GrainBond bond = like;
    bond.i = k;
    bond.j = k + 1;
    scene.bonds.push_back(bond);
  }
  return scene;
}

}  // namespace equidem::test
