// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The compiled loop for finite motions against the plain law of contact/finite_bond.hpp, and what it must conserve.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/finite_bond.hpp"
#include "equidem/core/random.hpp"

#include "dynamics/loop_by_hand.hpp"
#include "support/assemblies.hpp"
#include "support/bond_rates.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;
using std::numbers::pi;
using Springs = LoopKind::Springs;
using Resistance = LoopKind::Resistance;

namespace {

constexpr SpringConstants uniform_springs{2e3, 1.5e3}, dashpot_constants{3, 2};
constexpr double bending_dashpot = 0.004;

/// A hub with more contacts than the loop works on at a time.
Assembly star(int rays) {
  Assembly assembly;
  assembly.kind = "star";
  assembly.centres.push_back({0, 0});
  for (int k = 0; k < rays; ++k) {
    const double angle = 2 * pi * k / rays;
    assembly.centres.push_back({0.02 * std::cos(angle), 0.03 * std::sin(angle)});
    assembly.contacts.push_back({0, k + 1, 0, 0, 0, 0});
    assembly.contacts.back().lever_i = assembly.contacts.back().lever_j =
        0.5 * norm(assembly.branch(assembly.contacts.back()));
  }
  assembly.radii.assign(assembly.centres.size(), 0.001);
  assembly.cell_areas.assign(assembly.centres.size(), 1e-6);
  return assembly;
}

struct LoopScene {
  std::string name;
  Assembly assembly;
  ContactSprings springs;
  LoopKind kind;
};

/// Every assembly with every kind of loop: equal contacts, and contacts that differ in springs and levers, some of
/// which do not add up to the branch.
std::vector<LoopScene> loop_scenes() {
  std::vector<LoopScene> scenes;
  std::vector<std::pair<std::string, Assembly>> assemblies{{"star of 70", star(70)}};
  for (const AssemblyKind& kind : assembly_kinds()) assemblies.emplace_back(kind.name, kind.assembly);
  Random random(3);
  for (auto& [name, assembly] : assemblies) {
    for (const bool equal : {true, false}) {
      std::vector<SpringConstants> springs;
      for (Contact& contact : assembly.contacts) {
        const double length = norm(assembly.branch(contact)), share = equal ? 0.5 : random.uniform(0, 1);
        contact.lever_i = share * length;
        contact.lever_j = equal || random.uniform() < 0.5 ? length - contact.lever_i : random.uniform(0, length);
        springs.push_back(equal ? uniform_springs : SpringConstants{random.uniform(1e3, 3e3), random.uniform(0, 3e3)});
      }
      for (const Springs effects : {Springs::normal, Springs::tangential, Springs::rotation}) {
        for (const Resistance resistance :
             {Resistance::none, Resistance::body, Resistance::local, Resistance::dashpot}) {
          const LoopKind kind{.motion = LoopKind::Motion::finite,
                              .springs = effects,
                              .equal_contacts = equal,
                              .equal_discs = resistance == Resistance::none && equal,
                              .resistance = resistance};
          scenes.push_back({name + (equal ? ", equal contacts" : ", unequal contacts") + ", springs " +
                                std::to_string(static_cast<int>(effects)) + ", resistance " +
                                std::to_string(static_cast<int>(resistance)),
                            assembly, ContactSprings(springs), kind});
          if (equal || effects != Springs::rotation) continue;
          std::vector<double> bending(springs.size());
          for (double& kM : bending) kM = random.uniform(0, 0.01);
          scenes.push_back(scenes.back());
          scenes.back().name += ", bending";
          scenes.back().kind.bending = true;
          scenes.back().springs = ContactSprings(springs).with_bending(std::move(bending));
        }
      }
    }
  }
  return scenes;
}

/// The assembly turned about the origin by an angle, and every disc moved by some share of the mean radius and turned
/// by some angle.
std::vector<DiscMotion> turned_motions(const Assembly& assembly, double angle, double size, bool rotation,
                                       Random& random) {
  std::vector<DiscMotion> motions(assembly.size());
  const double c = std::cos(angle), s = std::sin(angle), a = assembly.mean_radius();
  for (std::size_t d = 0; d < motions.size(); ++d) {
    const Vec2 x = assembly.centres[d], turned{c * x.x - s * x.y, s * x.x + c * x.y};
    const auto draw = [&] { return size * random.uniform(-1, 1); };
    motions[d].u = turned - x + Vec2{a * draw(), a * draw()};
    motions[d].theta = rotation ? angle + draw() : 0;
  }
  return motions;
}

/// Sums of the plain law; `size` gathers the sum of the sizes of forces and moments, by which rounding is measured.
std::vector<DiscMotion> plain_forces(const LoopScene& scene, const std::vector<DiscMotion>& motions,
                                     const std::vector<DiscMotion>& velocities, double& force_size,
                                     double& moment_size) {
  std::vector<DiscMotion> sums(motions.size());
  force_size = moment_size = 0;
  for (std::size_t k = 0; k < scene.assembly.contacts.size(); ++k) {
    const Contact& contact = scene.assembly.contacts[k];
    SpringConstants springs = scene.springs[k], dashpots = dashpot_constants;
    if (scene.kind.springs == Springs::normal) springs.kT = dashpots.kT = 0;
    const FiniteBond bond = bond_of(scene.assembly, contact, springs);
    const BondMotion<double> motion = bond_motion(motions[contact.i], motions[contact.j]);
    ForceOf<double> stress = linear_spring_force(springs, bond_deformation(bond, motion));
    if (scene.kind.resistance == Resistance::dashpot) {
      const BondMotion<double> velocity = bond_motion(velocities[contact.i], velocities[contact.j]);
      const ForceOf<double> drag = linear_spring_force(dashpots, bond_deformation_rate(bond, motion, velocity));
      stress.normal += drag.normal;
      stress.tangential += drag.tangential;
    }
    BondForces<double> f = bond_forces(bond, motion, stress);
    double bending = bending_moment(scene.springs.bending(k), motion.theta_i, motion.theta_j);
    if (scene.kind.bending && scene.kind.resistance == Resistance::dashpot)
      bending += bending_moment(bending_dashpot, velocities[contact.i].theta, velocities[contact.j].theta);
    f.moment_i += bending;
    f.moment_j -= bending;
    sums[contact.i].u += {f.x, f.y};
    sums[contact.j].u -= {f.x, f.y};
    sums[contact.i].theta += f.moment_i;
    sums[contact.j].theta += f.moment_j;
    // Rounding of stretch and slip is that of l and, in turns, of the rotations.
    const double length = norm(bond.branch) + norm({motion.x, motion.y}), turns = 1 + std::abs(motion.theta_i);
    const double across = (contact.lever_i + contact.lever_j) / norm(bond.branch + Vec2{motion.x, motion.y});
    const double slipping = springs.kT * (contact.lever_i + contact.lever_j) * turns;
    force_size = std::max(force_size, springs.kN * length + slipping * across + norm({f.x, f.y}));
    moment_size = std::max(moment_size, slipping * norm(bond.branch) + std::abs(f.moment_i) + std::abs(f.moment_j));
  }
  return sums;
}

}  // namespace

TEST_CASE("the_loop_for_finite_motions_sums_the_forces_of_the_plain_law") {
  Random random(17);
  for (const LoopScene& scene : loop_scenes()) {
    const bool rotation = scene.kind.springs == Springs::rotation;
    LoopByHand loop(scene.assembly, scene.springs, {1, 1}, scene.kind, dashpot_constants, bending_dashpot);
    // Sizes on either side of the bound between the short polynomials and the general formulas.
    for (const double size : {1e-7, 5e-3, 2e-2, 0.4}) {
      for (const double angle : {0.0, 0.2, -2.5, 44.0}) {
        const std::vector<DiscMotion> motions = turned_motions(scene.assembly, angle, size, rotation, random),
                                      velocities = turned_motions(scene.assembly, 0, 1, rotation, random);
        loop.set_motions(motions);
        if (scene.kind.resistance == Resistance::dashpot) loop.set_dashpot_velocities(velocities);
        double force_size = 0, moment_size = 0;
        const std::vector<DiscMotion> expected = plain_forces(scene, motions, velocities, force_size, moment_size);
        const std::vector<DiscMotion> forces = loop.forces();
        double force_error = 0, moment_error = 0;
        for (std::size_t d = 0; d < forces.size(); ++d) {
          force_error = std::max(force_error, norm(forces[d].u - expected[d].u));
          if (rotation) moment_error = std::max(moment_error, std::abs(forces[d].theta - expected[d].theta));
        }
        CAPTURE(scene.name, size, angle, force_error / force_size, moment_error / moment_size);
        REQUIRE(force_error <= 1e-14 * force_size);
        REQUIRE(moment_error <= 1e-14 * moment_size);
      }
    }
  }
}

TEST_CASE("finite_motions_differ_from_small_ones_by_the_square_of_their_size") {
  Random random(23);
  for (const LoopScene& scene : loop_scenes()) {
    // A disc that touches only its own images moves relative to nothing.
    if (!scene.kind.equal_contacts || scene.kind.resistance != Resistance::none || scene.assembly.size() == 1) continue;
    for (const bool equal : {true, false}) {
      LoopKind finite = scene.kind;
      finite.equal_contacts = finite.equal_discs = equal;
      LoopKind small = finite;
      small.motion = LoopKind::Motion::small;
      LoopByHand curved(scene.assembly, scene.springs, {1, 1}, finite),
          straight(scene.assembly, scene.springs, {1, 1}, small);
      const bool rotation = finite.springs == Springs::rotation;
      const std::vector<DiscMotion> direction = turned_motions(scene.assembly, 0, 1, rotation, random);
      const auto difference = [&](double size) {
        std::vector<DiscMotion> motions = direction;
        for (DiscMotion& motion : motions) motion = {size * motion.u, size * motion.theta};
        curved.set_motions(motions);
        straight.set_motions(motions);
        const std::vector<DiscMotion> f = curved.forces(), g = straight.forces();
        double largest = 0;
        for (std::size_t d = 0; d < f.size(); ++d) largest = std::max(largest, norm(f[d].u - g[d].u));
        return largest;
      };
      const double coarse = difference(2e-4), fine = difference(1e-4);
      CAPTURE(scene.name, coarse, fine);
      // Where opposite bonds of a disc move alike their squares cancel, and the cube is left.
      CHECK(std::log2(coarse / fine) > 1.98);
    }
  }
}

TEST_CASE("a_block_that_spins_freely_keeps_its_energy_without_drift") {
  const Assembly block = hexagonal_lattice({.columns = 6, .rows = 5, .radius = 0.5});
  const SpringConstants k{1, 0.5};
  const Inertia inertia{1, 0.125};
  const LoopKind kind{.motion = LoopKind::Motion::finite, .springs = Springs::rotation};
  LoopByHand loop(block, ContactSprings(k), inertia, kind);
  const double spin = 0.02, dt = 0.25;  // dt about 0.3 of the critical step
  const int samples = 2000, every = 50;

  // Spinning about the middle, and every disc shaken on top.
  Vec2 middle;
  for (const Vec2 x : block.centres) middle += x / static_cast<double>(block.size());
  Random random(1);
  std::vector<DiscMotion> start(block.size());
  for (std::size_t d = 0; d < start.size(); ++d) {
    const auto draw = [&] { return 0.01 * random.uniform(-1, 1); };
    start[d] = {spin * perpendicular(block.centres[d] - middle) + Vec2{draw(), draw()}, spin + draw()};
  }
  // In place: the rounding of positions grows with the way gone, and angular momentum walks at random with it.
  Vec2 flight;
  for (const DiscMotion& disc : start) flight += disc.u / static_cast<double>(block.size());
  for (DiscMotion& disc : start) disc.u -= flight;
  loop.set_velocities(start);
  const Stage stage{.keep = 1, .kick = dt, .drift = dt, .drift_before = 0, .duration = dt};
  const auto elastic = [&](const std::vector<DiscMotion>& motions) {
    double sum = 0;
    for (const Contact& contact : block.contacts) {
      sum += bond_energy(bond_of(block, contact, k), motions[contact.i], motions[contact.j]);
    }
    return sum;
  };
  const auto angular_momentum = [&](const std::vector<DiscMotion>& motions, const std::vector<DiscMotion>& v) {
    double sum = 0;
    for (std::size_t d = 0; d < v.size(); ++d) {
      sum += inertia.mass * cross(block.centres[d] + motions[d].u, v[d].u) + inertia.moment * v[d].theta;
    }
    return sum;
  };

  std::vector<double> energies;
  double turned = 0, most_elastic = 0;
  const double momentum_before = angular_momentum(loop.motions(), loop.velocities());
  for (int sample = 0; sample < samples; ++sample) {
    for (int n = 1; n < every; ++n) loop.step(stage);
    // At the same time: positions, and the mean of the velocities half a step before and after.
    const std::vector<DiscMotion> motions = loop.motions(), before = loop.velocities();
    loop.step(stage);
    const std::vector<DiscMotion> after = loop.velocities();
    double kinetic = 0;
    for (std::size_t d = 0; d < motions.size(); ++d) {
      const Vec2 v = 0.5 * (before[d].u + after[d].u);
      const double omega = 0.5 * (before[d].theta + after[d].theta);
      kinetic += 0.5 * (inertia.mass * dot(v, v) + inertia.moment * omega * omega);
    }
    most_elastic = std::max(most_elastic, elastic(motions));
    energies.push_back(kinetic + elastic(motions));
    turned = motions[0].theta;
  }
  const double momentum = angular_momentum(loop.motions(), loop.velocities());

  const auto [least, most] = std::minmax_element(energies.begin(), energies.end());
  double mean = 0, slope = 0, squares = 0;
  for (const double energy : energies) mean += energy / samples;
  for (int n = 0; n < samples; ++n) {
    const double t = (n + 0.5) / samples - 0.5;
    slope += t * (energies[n] - mean);
    squares += t * t;
  }
  slope /= squares;  // per run
  CAPTURE(turned, mean, most_elastic, (*most - *least) / mean, slope / mean, momentum / momentum_before - 1);
  CHECK(turned > 20 * 2 * pi);
  CHECK(most_elastic > 1e-3 * mean);
  CHECK(*most - *least < 0.03 * most_elastic);
  CHECK(std::abs(slope) < 0.05 * (*most - *least));
  CHECK(std::abs(momentum / momentum_before - 1) < 1e-16 * samples * every);  // less than one rounding a step
}
