// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/make_bonds.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/geometry/neighbours.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/contacts/bond_step.hpp"

namespace equidem {
namespace {

using PairOfGrains = std::pair<std::size_t, std::size_t>;

/// The rest of a bond whose springs carry the force of a contact now.
BondRest rest_under(const GrainContact& contact, const GrainBond& bond, const BondRest& now) {
  const double length = norm(now.branch);
  const double at_rest = length + (bond.normal_spring > 0 ? contact.normal_force / bond.normal_spring : 0);
  const double turn =
      bond.tangential_spring > 0 ? contact.tangential_force * length / (bond.tangential_spring * at_rest * at_rest) : 0;
  if (!(at_rest > 0) || !(at_rest < 2 * length) || !(std::abs(turn) < std::numbers::pi / 2))
    bad_input(fmt::format("the contact of grains {} and {} carries {:.3g} along and {:.3g} across", bond.i, bond.j,
                          contact.normal_force, contact.tangential_force),
              "the springs of the new bond are too soft to carry that", "Give stiffer springs");
  const double c = std::cos(turn), s = std::sin(turn);
  const Vec2 n = now.branch / length;
  return {at_rest * Vec2{c * n.x - s * n.y, s * n.x + c * n.y}, now.angle_i, now.angle_j};
}

/// The pairs whose gap is at most a share of the sum of their radii, as touching_discs; in a periodic cell with the
/// nearest image. Ascending.
std::set<PairOfGrains> near_discs(const GrainScene& scene, double gap_tolerance) {
  constexpr double rounding_gap = 1e-9;  // of the smaller radius
  std::vector<Circle> circles;           // larger by the gap
  for (const Grain& grain : scene.grains)
    circles.push_back({grain.position, grain.radius * (1 + gap_tolerance + 2 * rounding_gap)});
  std::optional<Periods> periods;
  if (scene.cell) periods = periods_of(*scene.cell);
  std::set<PairOfGrains> pairs;
  for (const CirclePair& near : pairs_within(circles, periods, 0)) {
    const auto i = static_cast<std::size_t>(near.i), j = static_cast<std::size_t>(near.j.body);
    const double r = scene.grains[i].radius, s = scene.grains[j].radius;
    const double gap = norm(circles[j].centre + near.shift - circles[i].centre) - r - s;
    if (i != j && gap <= std::max(rounding_gap * std::min(r, s), gap_tolerance * (r + s))) pairs.insert({i, j});
  }
  return pairs;
}

}  // namespace

void check(const StageBonds& bonds, std::span<const Grain> grains, const GrainOptions& options) {
  if (!(bonds.gap_tolerance >= 0) || bonds.gap_tolerance > 1)
    bad_input(fmt::format("the gap tolerance of bonds is {}", bonds.gap_tolerance),
              "it is a share of the sum of two radii", "Give a number from 0 to 1");
  for (std::size_t k = 0; k < grains.size(); ++k)
    if (grains[k].shape() != GrainShape::disc)
      bad_input(fmt::format("grain {} is no disc", k), "bonds tie discs", "Take the bonds out of the stages");
  GrainScene pair;
  pair.grains.resize(2);
  for (Grain& grain : pair.grains) grain.radius = 1, grain.inertia = {1, 1};
  pair.grains[1].position = {2, 0};
  pair.bonds = {bonds.like};
  pair.bonds[0].i = 0;
  pair.bonds[0].j = 1;
  if (bonds.strengths) pair.strengths = bond_strengths(pair, *bonds.strengths);
  check_bonds(pair);
  check_law_of_bonds(pair, options.law);
}

double likely_step_limit(std::span<const Grain> grains, const StageBonds& bonds, GrainOptions::BondStep bond_step) {
  const Grain& lightest = *std::ranges::min_element(grains, {}, [](const Grain& grain) { return grain.inertia.mass; });
  GrainScene hexagon;
  hexagon.grains.assign(7, lightest);
  for (std::size_t k = 1; k < hexagon.grains.size(); ++k) {
    const double angle = std::numbers::pi / 3 * static_cast<double>(k);
    hexagon.grains[k].position += 2 * lightest.radius * Vec2{std::cos(angle), std::sin(angle)};
    hexagon.bonds.push_back(bonds.like);
    hexagon.bonds.back().i = 0, hexagon.bonds.back().j = k;
  }
  return bond_step_limit(hexagon, bond_step);
}

std::vector<GrainBond> make_bonds(const GrainScene& scene, std::span<const GrainContact> contacts,
                                  std::span<const GrainBond> known, const StageBonds& how) {
  std::set<PairOfGrains> tied;
  for (const GrainBond& bond : known) tied.insert(std::minmax(bond.i, bond.j));
  std::map<PairOfGrains, const GrainContact*> pressed;
  for (const GrainContact& contact : contacts)
    if (contact.j >= 0) pressed[{static_cast<std::size_t>(contact.i), static_cast<std::size_t>(contact.j)}] = &contact;
  std::vector<GrainBond> made;
  for (const PairOfGrains& near : near_discs(scene, how.gap_tolerance)) {
    if (tied.contains(near)) continue;
    GrainBond& bond = made.emplace_back(how.like);
    std::tie(bond.i, bond.j) = near;
    bond.rest = rest_of(scene, bond.i, bond.j);
    if (const auto at = pressed.find(near); at != pressed.end()) bond.rest = rest_under(*at->second, bond, *bond.rest);
  }
  return made;
}

}  // namespace equidem
