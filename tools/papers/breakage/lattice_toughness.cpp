// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Toughness of the infinite lattice: the field of a crack around its tip.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/contact/effects.hpp"
#include "equidem/statics/stiffness_solver.hpp"

#include "breakage/breakage.hpp"

namespace equidem::breakage {
namespace {

/// Hexagonal lattice of the distance 1 within a circle about the tip of a crack, which opens the row of triangles along
/// y = 0 for x < 0: its contacts are missing. The discs of the rim are held.
Assembly disc_about_tip(double radius) {
  constexpr double half_row = 0.4330127018922193, touching = 1.001;  // sqrt3/4
  Assembly lattice;
  const auto reach = static_cast<int>(radius) + 2;
  for (int row = -2 * reach; row <= 2 * reach; ++row) {
    const double y = half_row * (2 * row + 1), shift = row % 2 == 0 ? 0 : 0.5;
    for (int column = -reach; column <= reach; ++column) {
      const Vec2 centre{column + shift, y};
      if (norm(centre) < radius) lattice.centres.push_back(centre);
    }
  }
  lattice.radii.assign(lattice.centres.size(), 0.5);
  constexpr double rim = 2.5;  // wide enough for every contact of the discs inside
  for (std::size_t i = 0; i < lattice.centres.size(); ++i) {
    const Vec2 at = lattice.centres[i];
    if (norm(at) > radius - rim) lattice.groups["rim"].discs.push_back(static_cast<std::int32_t>(i));
    // Discs are in the order of their rows: neighbours ahead are at most a row and two discs away.
    for (std::size_t j = i + 1; j < lattice.centres.size() && lattice.centres[j].y < at.y + 1; ++j) {
      const Vec2 other = lattice.centres[j];
      const bool opened = at.y * other.y < 0 && at.x + other.x < 0;
      if (norm(other - at) > touching || opened) continue;
      lattice.contacts.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), 0, 0, 0.5, 0.5});
    }
  }
  return lattice;
}

/// Displacement at a place about the tip of a crack along x < 0 in mode I with K = 1 (Williams 1957): of an isotropic
/// plate with the two-dimensional shear modulus G and kappa = (3 - nu)/(1 + nu).
Vec2 mode_one(Vec2 at, double shear, double kappa) {
  const double half = 0.5 * std::atan2(at.y, at.x), size = std::sqrt(norm(at) / (2 * std::numbers::pi)) / (2 * shear);
  return {size * std::cos(half) * (kappa - 1 + 2 * squared(std::sin(half))),
          size * std::sin(half) * (kappa + 1 - 2 * squared(std::cos(half)))};
}

/// K at which the first contact reaches the force 1, with kN = 1.
double toughness_within(double radius, double ratio) {
  const Assembly lattice = disc_about_tip(radius);
  const ContactSprings springs(SpringConstants{1, ratio});
  const Effects effects = derive_effects(lattice, springs, Rotation::from_scene);
  const std::vector<Support> rim{{"rim", 0, 0, {}}};
  const DegreesOfFreedom unknowns = number_unknowns(lattice, springs, effects, rim);
  const double bulk = 0.5 * std::sqrt(3.0), shear = 0.25 * std::sqrt(3.0) * (1 + ratio);
  const double nu = (bulk - shear) / (bulk + shear), kappa = (3 - nu) / (1 + nu);
  RightHandSide moved;
  moved.prescribed.assign(unknowns.held.size(), 0.0);
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  for (const std::int32_t disc : lattice.groups.at("rim").discs) {
    const auto d = static_cast<std::size_t>(disc);
    const Vec2 u = mode_one(lattice.centres[d], shear, kappa);
    moved.prescribed[d * b] = u.x, moved.prescribed[d * b + 1] = u.y;
  }
  StageTimes times;
  const StiffnessSolver solver(lattice, springs, ContactGraph(lattice), unknowns, {}, Mechanisms::refuse, times);
  const std::vector<Solution> solution = solver.solve({&moved, 1}, times);
  double largest = 0;
  for (std::size_t c = 0; c < lattice.contacts.size(); ++c)
    largest = std::max(largest, solver.deformation(moved, solution.front().motion, c).normal);
  return 1 / largest;
}

}  // namespace

double lattice_toughness(double ratio, bool quick) {
  // The field is that of a continuum at the rim: what it lacks there falls with the radius.
  const double near = quick ? 20 : 40;
  return 2 * toughness_within(2 * near, ratio) - toughness_within(near, ratio);
}

}  // namespace equidem::breakage
