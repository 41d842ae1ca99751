// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs, ellipses, clumps and bonded pairs in hard cases, and what a run keeps.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"

#include "grains/bonded_scenes.hpp"
#include "grains/shapes.hpp"

namespace equidem::test {

enum class BodyKind { disc, ellipse, clump, bonded_pair };
inline constexpr std::array all_bodies{BodyKind::disc, BodyKind::ellipse, BodyKind::clump, BodyKind::bonded_pair};

inline std::string name_of(BodyKind kind) {
  constexpr std::array names{"discs", "ellipses", "clumps", "bonded pairs"};
  return names[static_cast<std::size_t>(kind)];
}

/// A body of mass 1, or a bonded pair of mass 2, in a circle of the radius given: an ellipse of aspect 2, a clump of
/// three discs, a pair of two.
inline void add_body(GrainScene& scene, BodyKind kind, Vec2 place, double radius, double angle = 0,
                     Vec2 velocity = {}) {
  const double r = radius;
  if (kind == BodyKind::disc) scene.grains.push_back(ball(place, r, velocity));
  if (kind == BodyKind::ellipse) scene.grains.push_back(oval(place, r, r / 2, angle, velocity));
  if (kind == BodyKind::clump) {
    scene.grains.push_back(
        lump(scene, {{{0, 0}, r / 2}, {{r / 2, 0}, r / 3}, {{0, r / 2}, r / 4}}, place, angle, velocity));
  }
  if (kind != BodyKind::bonded_pair) return;
  const std::size_t first = scene.grains.size();
  const Vec2 half = 0.5 * r * Vec2{std::cos(angle), std::sin(angle)};
  scene.grains.push_back(ball(place - half, r / 2, velocity));
  scene.grains.push_back(ball(place + half, r / 2, velocity));
  scene.bonds.push_back({.i = first,
                         .j = first + 1,
                         .normal_dashpot = 100,
                         .tangential_dashpot = 30,
                         .rolling_dashpot = 0.1,
                         .normal_spring = 1000,
                         .tangential_spring = 300});
}

/// In shares of the largest that was there.
struct Balance {
  double energy = 0;                 ///< error of the ledger, of the energy at the start and put in by walls
  double momentum = 0, angular = 0;  ///< changes, of the sums of absolute values
  std::int64_t contacts = 0;         ///< begun
};

/// Advance in a hundred parts, watching.
inline Balance keep(GrainSimulation& simulation, std::int64_t steps) {
  const std::vector<Grain> start = simulation.grains();
  const Momenta before = momenta_of(start);
  double linear = 0, angular = 0, put_in = 0;
  for (const Grain& g : start) {
    linear += g.inertia.mass * norm(g.velocity);
    angular += g.inertia.mass * norm(g.position) * norm(g.velocity) + g.inertia.moment * std::abs(g.spin);
  }
  Balance balance;
  for (int part = 0; part < 100; ++part) {
    simulation.advance(steps / 100);
    const Momenta now = momenta_of(simulation.grains());
    const EnergyLedger ledger = simulation.energy();
    put_in = std::max(put_in, ledger.initial + std::abs(ledger.work_of_walls) + std::abs(ledger.potential));
    balance.energy = std::max(balance.energy, std::abs(ledger.error()));
    balance.momentum = std::max(balance.momentum, norm(now.linear - before.linear) / linear);
    balance.angular = std::max(balance.angular, std::abs(now.angular - before.angular) / angular);
  }
  balance.energy /= put_in;
  balance.contacts = simulation.counters().contacts;
  return balance;
}

/// The force that a body lacks for its balance, of the largest contact force; in shares, the largest.
inline double lack_of_balance(const GrainSimulation& simulation, const GrainScene& scene) {
  const std::vector<Grain> grains = simulation.grains();
  std::vector<Vec2> forces;
  for (const Grain& grain : grains) forces.push_back(grain.inertia.mass * scene.gravity);
  double carried = 0, lack = 0;
  for (const GrainContact& c : simulation.contacts()) {
    const Vec2 on_j = c.normal_force * c.normal + c.tangential_force * perpendicular(c.normal);
    forces[static_cast<std::size_t>(c.i)] -= on_j;
    if (c.j >= 0) forces[static_cast<std::size_t>(c.j)] += on_j;
    carried = std::max(carried, norm(on_j));
  }
  for (const GrainBond& bond : scene.bonds) {  // one body
    forces[bond.i] += forces[bond.j];
    forces[bond.j] = {};
  }
  for (const Vec2 force : forces) lack = std::max(lack, norm(force));
  return lack / carried;
}

inline GrainOptions verlet(double step) {
  return options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, step);
}

/// Floor, left, right and lid.
inline std::vector<Wall> closed_box(double width, double height) {
  return {line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}), line("right", {width, 0}, {-1, 0}),
          line("lid", {0, height}, {0, -1})};
}

inline std::string digits(double x) {
  return fmt::format("{:.1e}", x);
}

}  // namespace equidem::test
