// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Small random networks, near to mechanisms and beyond, that dense matrices judge.
#pragma once

#include <cmath>
#include <cstdint>
#include <set>
#include <tuple>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/random.hpp"

namespace equidem::test {

/// A random share of the contacts has one, of the size of the other springs of 1 and levers of 0.5.
inline std::vector<double> random_bending(std::size_t contacts, Random& random) {
  const double bonded = random.uniform();
  std::vector<double> bending(contacts);
  for (double& kM : bending) kM = random.uniform() < bonded ? random.uniform(0.1, 0.5) : 0.0;
  return bending;
}

/// kN about 1; kT of a share of them.
inline ContactSprings drawn_springs(std::size_t contacts, double tangential, bool bends, Random& random) {
  std::vector<SpringConstants> springs(contacts);
  for (auto& k : springs) k = {random.uniform(0.5, 2), random.uniform() < tangential ? random.uniform(0.2, 1) : 0.0};
  const ContactSprings result(springs);
  return bends ? result.with_bending(random_bending(contacts, random)) : result;
}

inline Assembly shaken_lattice(bool hexagonal, const LatticeOptions& options, Random& random) {
  Assembly a = hexagonal ? hexagonal_lattice(options) : square_lattice(options);
  if (random.uniform() < 0.3) return a;
  for (Vec2& x : a.centres) x += {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
  for (double& r : a.radii) r = random.uniform(0.3, 0.6);
  return a;
}

/// Ways to place the contact points: in the middle, at the radii's share, anywhere, at the centre of some discs,
/// at the distance of the radii (levers then do not add up), and at both centres of some.
inline void place_contact_points(Assembly& a, Random& random) {
  const std::uint64_t levers = random.below(6);
  for (Contact& c : a.contacts) {
    const double l = norm(a.branch(c)), r_i = a.radii[c.i], r_j = a.radii[c.j];
    double share = levers == 0 ? 0.5 : r_i / (r_i + r_j);
    if (levers == 1) share = random.uniform(0.3, 0.7);
    if (levers == 2 && random.uniform() < 0.2) share = 0;
    c.lever_i = levers == 3 ? r_i : share * l;
    c.lever_j = levers == 3 ? r_j : l - c.lever_i;
    if (levers == 4 && random.uniform() < 0.2) c.lever_i = c.lever_j = 0;
  }
}

/// A disc, and the cell of the periodic plane in which it is.
using Image = std::tuple<int, int, int>;

/// All images that contacts join to an image, followed across a few periods in the plane tiled with the cell.
inline std::set<Image> images_joined_to(const Assembly& assembly, int disc) {
  std::set<Image> found{{disc, 0, 0}};
  std::vector<Image> open{{disc, 0, 0}};
  const auto visit = [&](int d, int x, int y) {
    if (std::abs(x) < 8 && std::abs(y) < 8 && found.insert({d, x, y}).second) open.emplace_back(d, x, y);
  };
  while (!open.empty()) {
    const auto [d, x, y] = open.back();
    open.pop_back();
    for (const Contact& c : assembly.contacts) {
      if (c.i == d) visit(c.j, x + c.shift_x, y + c.shift_y);
      if (c.j == d) visit(c.i, x - c.shift_x, y - c.shift_y);
    }
  }
  return found;
}

}  // namespace equidem::test
