// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/stage.hpp"

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
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {
namespace {

std::vector<std::size_t> idle(const std::vector<char>& held) {
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < held.size(); ++k)
    if (held[k] == 0) numbers.push_back(k);
  return numbers;
}

}  // namespace

bool BodyChoice::holds(const Grain& grain) const {
  if (!kinds.empty() && std::ranges::find(kinds, grain.kind) == kinds.end()) return false;
  if (!box) return true;
  const Vec2 at = grain.position;
  return box->low.x <= at.x && at.x <= box->high.x && box->low.y <= at.y && at.y <= box->high.y;
}

void change_bodies(std::vector<Grain>& bodies, const StageBodies& how, std::size_t first_added, StageReport& report) {
  std::vector<char> removes(how.removed.size(), 0), renames(how.renamed.size(), 0);
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    Grain& grain = bodies[k];
    if (!grain.present) continue;
    for (std::size_t c = 0; c < how.removed.size(); ++c)
      if (how.removed[c].holds(grain)) grain.present = false, removes[c] = 1;
    report.removed += grain.present ? 0 : 1;
    if (!grain.present) continue;
    const int kind = grain.kind;
    for (std::size_t c = 0; c < how.renamed.size(); ++c)
      if (how.renamed[c].which.holds(grain)) grain.kind = how.renamed[c].kinds[k], renames[c] = 1;
    report.renamed += grain.kind != kind ? 1 : 0;
  }
  report.idle_removals = idle(removes);
  report.idle_renamings = idle(renames);
  std::ranges::copy(how.added, bodies.begin() + static_cast<std::ptrdiff_t>(first_added));
  if (std::ranges::none_of(bodies, &Grain::present))
    bad_input("all bodies are removed", "there is nothing left to move", "Remove fewer, or add some");
}

std::vector<std::int32_t> wall_origins(const GrainStage& stage, const GrainStage& before) {
  const std::vector<std::string> names = names_of(before.scene.walls);
  std::vector<std::int32_t> origins;
  for (const Wall& wall : stage.scene.walls) {
    const auto renamed = std::ranges::find(stage.renamed_walls, wall.name, &WallRenaming::to);
    const auto at = std::ranges::find(names, renamed == stage.renamed_walls.end() ? wall.name : renamed->from);
    origins.push_back(at == names.end() ? -1 : static_cast<std::int32_t>(at - names.begin()));
  }
  return origins;
}

namespace {

void check_walls(const GrainStage& stage) {
  const std::vector<std::string> names = names_of(stage.scene.walls);
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(k), names[k]) ==
        names.begin() + static_cast<std::ptrdiff_t>(k))
      continue;
    bad_input(fmt::format("stage '{}' has two walls '{}'", stage.name, names[k]), "a wall goes on by its name",
              "Give each its own name");
  }
  const auto need = [&](const std::string& name) {
    if (std::ranges::find(names, name) != names.end()) return;
    bad_input(fmt::format("stage '{}' ends by the wall '{}'", stage.name, name), "it has no such wall",
              "Name a wall that stands in this stage");
  };
  if (stage.end.displacement > 0) need(stage.end.wall);
  if (stage.end.of_cell && !(stage.scene.cell && stage.scene.cell->along == PeriodicCell::Along::xy))
    bad_input(fmt::format("stage '{}' ends by the strain of a periodic cell", stage.name),
              "there is no cell that repeats along x and y", "Name two walls between which the strain is");
  if (stage.end.strain > 0 && !stage.end.of_cell)
    for (const std::string& name : stage.end.walls) need(name);
}

}  // namespace

void check(std::span<const GrainStage> stages, const GrainOptions& options) {
  const GrainStage& first = stages.front();
  if (first.bodies.change())
    bad_input(fmt::format("stage '{}' changes the bodies", first.name), "it is the first, and begins with the scene",
              "Give the scene those bodies");
  for (const GrainStage& stage : stages) {
    if (stage.scene.cell.has_value() != first.scene.cell.has_value())
      bad_input(fmt::format("of the stages '{}' and '{}' one has a periodic cell", first.name, stage.name),
                "a cell neither comes nor goes", "Give all stages the cell, or none");
    check_walls(stage);
    const bool breaks = first.scene.strengths.has_value();
    if (stage.bonds && stage.bonds->strengths.has_value() != breaks && !first.scene.bonds.empty())
      bad_input(fmt::format("of the bonds of stage '{}' and those before it some alone have strengths", stage.name),
                "those without would never break, and none says so", "Give strengths to all bonds, or to none");
    if (stage.bonds) check(*stage.bonds, first.scene.grains, options);
    if (&stage == &first) continue;
    const std::vector<std::int32_t> origins = wall_origins(stage, *(&stage - 1));
    for (std::size_t w = 0; w < origins.size(); ++w)
      if (origins[w] >= 0) check_start(stage.scene.walls[w]);
  }
}

Effects effects_of(const std::vector<GrainStage>& stages, const GrainOptions& options) {
  GrainScene all = stages.front().scene;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (const GrainStage& stage : stages) {
    if (&stage != &stages.front()) {
      append(all.pairs, stage.scene.pairs);
      append(all.walls, stage.scene.walls);
      append(all.grains, stage.bodies.added);
      if (!all.weighs()) all.gravity = stage.scene.gravity;
      if (stage.scene.cell && stage.scene.cell->deforms()) all.cell = stage.scene.cell;
    }
    if (!stage.bonds) continue;
    all.bonds.push_back(stage.bonds->like);
    if (stage.bonds->strengths) all.strengths.emplace();
  }
  return effects_of(all, options);
}

std::vector<std::string> active_effects(const Effects& effects) {
  std::vector<std::string> names;
  for (const Effects::Entry& entry : effects.entries)
    if (entry.active) names.push_back(entry.name);
  return names;
}

void check_start(const Wall& wall) {
  const Vec2 jump = wall.displacement(0);
  if (jump == Vec2{}) return;
  bad_input(
      fmt::format("wall '{}' would jump by ({:.6g}, {:.6g}) m where its motion begins", wall.name, jump.x, jump.y),
      "a wall that stands moves on from its place", "Let its schedule begin with 0");
}

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
  std::vector<std::size_t> numbers;
  for (const Grain& grain : scene.present()) {
    circles.push_back({grain.position, grain.radius * (1 + gap_tolerance + 2 * rounding_gap)});
    numbers.push_back(static_cast<std::size_t>(&grain - scene.grains.data()));
  }
  std::optional<Periods> periods;
  if (scene.cell) periods = periods_of(*scene.cell);
  std::set<PairOfGrains> pairs;
  for (const CirclePair& near : pairs_within(circles, periods, 0)) {
    const std::size_t i = numbers[near.i], j = numbers[near.j.body];
    const double r = scene.grains[i].radius, s = scene.grains[j].radius;
    const double gap = norm(circles[near.j.body].centre + near.shift - circles[near.i].centre) - r - s;
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
                                  const StageBonds& how) {
  std::set<PairOfGrains> tied;
  for (const GrainBond& bond : scene.bonds) tied.insert(std::minmax(bond.i, bond.j));
  std::map<std::pair<std::int32_t, std::int32_t>, const GrainContact*> pressed;
  for (const GrainContact& contact : contacts)
    if (contact.j >= 0) pressed[{contact.i, contact.j}] = &contact;
  const bool touch = how.strengths && how.strengths->after_breaking == AfterBreaking::parallel;
  std::vector<GrainBond> made;
  for (const PairOfGrains& near : near_discs(scene, how.gap_tolerance)) {
    if (tied.contains(near)) continue;
    GrainBond& bond = made.emplace_back(how.like);
    std::tie(bond.i, bond.j) = near;
    bond.rest = rest_of(scene, bond.i, bond.j);
    const auto at = pressed.find({static_cast<std::int32_t>(bond.i), static_cast<std::int32_t>(bond.j)});
    if (at != pressed.end() && !touch) bond.rest = rest_under(*at->second, bond, *bond.rest);
  }
  return made;
}

}  // namespace equidem
