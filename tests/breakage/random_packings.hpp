// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Random networks of bonds and contacts without a bond, with what drives them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/breakage/load_path.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/breakage/unbonded/unbonded_run.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

namespace equidem::test {

struct DrawnPacking {
  std::string name;
  Assembly assembly;
  ContactSprings springs{SpringConstants{1, 0.3}};
  ContactStrengths strengths;
  LoadPathOptions path;
  UnbondedOptions unbonded;
  Rotation rotation = Rotation::from_scene;
};

/// Assemblies of about ten discs, loaded, unloaded and reloaded: bonds and contacts without a bond, gaps and forces at
/// rest at random, in every combination of what drives them, tangential springs and friction.
inline DrawnPacking draw_packing(std::uint64_t seed) {
  Random random(seed);
  DrawnPacking d;
  const bool periodic = seed % 3 == 0;
  d.assembly = delaunay_assembly({.discs = periodic ? 8 : 10,
                                  .points = PointProcess::perturbed_hexagonal,
                                  .disorder = 0.25,
                                  .seed = seed,
                                  .radii = {.smallest = 0.5, .largest = 0.5},
                                  .periodic = periodic});
  const double kT = std::array{0.5, 0.0, 1.0, 0.2}[seed / 3 % 4];
  const double friction = std::array{0.3, 0.0, 0.6, 10.0, 0.1}[seed % 5];
  const double bonded = std::array{0.0, 0.5, 0.9, 1.0}[seed / 2 % 4];
  const int rest = static_cast<int>(seed / 5 % 3);  // 0: no forces at rest, 1: gaps, 2: forces
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < d.assembly.contacts.size(); ++c) {
    springs.push_back({random.uniform(0.5, 2), kT * random.uniform(0.5, 2)});
    const bool bond = random.uniform(0, 1) < bonded;
    d.strengths.tension.push_back(bond ? random.uniform(0.2, 1.5) : 0);
    d.strengths.shear.push_back(bond ? random.uniform(0.2, 1.5) : 0);
    if (rest == 1) d.unbonded.rest.push_back({bond ? 0 : std::max(0.0, random.uniform(-0.3, 0.3)), 0});
    if (rest == 2) {
      const double n = -random.uniform(0.2, 1);
      d.unbonded.rest.push_back({n, bond || kT > 0 ? friction * n * random.uniform(-0.9, 0.9) : 0});
      if (friction > 1) d.unbonded.rest.back().tangential = 0.3 * n;
      if (kT == 0) d.unbonded.rest.back().tangential = 0;
    }
  }
  d.springs = ContactSprings(std::move(springs));
  if (rest == 2 && bonded > 0) {
    for (std::size_t c = 0; c < d.strengths.shear.size(); ++c) d.strengths.shear[c] *= d.strengths.shear[c] > 0 ? 4 : 0;
  }
  d.strengths.friction = std::array{0.0, 0.5}[seed % 2];
  d.unbonded.friction = friction;
  if (seed % 7 == 0) d.rotation = Rotation::restrained;
  d.name = fmt::format("seed {}, kT {}, friction {}, bonded {}, rest {}", seed, kT, friction, bonded, rest);
  d.path.control = LoadControl::motion;
  d.path.legs = {1.5, -0.5, 2};
  const auto part = [&] { return random.uniform(-1, 1); };
  if (periodic) {
    d.path.strain = Voigt{part(), part(), part()};
    d.name += ", strain";
    return d;
  }
  d.path.supports = {{"bottom", 0, 0, {}}};
  if (seed % 2 == 1) {
    d.path.supports.push_back({"top", part(), -std::abs(part()), {}});
    d.name += ", motion";
  } else {
    d.path.loads = {{"top", LoadKind::per_disc, {0.4 * part(), -std::abs(part())}, 0}};
    d.path.control = LoadControl::load;
    d.name += ", loads";
  }
  if (seed % 4 >= 2 && seed % 2 == 0) {
    d.path.dead_loads = {{"top", LoadKind::per_disc, {0.05 * part(), -0.5}, 0}};
    d.name += ", dead loads";
  }
  return d;
}

}  // namespace equidem::test
