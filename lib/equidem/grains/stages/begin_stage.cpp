// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How a stage begins: its bodies, walls and bonds.

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/geometry/neighbours.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/contacts/bond_step.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"

namespace equidem {

namespace {

constexpr double energy_rounding = 1e-13;  // of sums over all bodies and contacts

/// The place that each body has now; -1: it is gone. \param origins as in ChangedBodies
std::vector<std::int32_t> places_after(std::size_t before, const std::vector<std::int32_t>& origins) {
  std::vector<std::int32_t> places(before, -1);
  for (std::size_t k = 0; k < origins.size(); ++k)
    if (origins[k] >= 0) places[origins[k]] = static_cast<std::int32_t>(k);
  return places;
}

/// Bodies in the order of the loops: those that stay as they were, then new ones.
std::vector<std::size_t> order_now(const std::vector<std::size_t>& before, const std::vector<std::int32_t>& origins) {
  const std::vector<std::int32_t> places = places_after(before.size(), origins);
  std::vector<std::size_t> order;
  for (const std::size_t body : before)
    if (places[body] >= 0) order.push_back(static_cast<std::size_t>(places[body]));
  for (std::size_t k = 0; k < origins.size(); ++k)
    if (origins[k] < 0) order.push_back(k);
  return order;
}

/// The contacts between bodies that stay.
std::vector<GrainContact> contacts_now(const GrainSimulation& simulation, const std::vector<std::int32_t>& origins) {
  const std::vector<std::int32_t> places = places_after(simulation.order().size(), origins);
  std::vector<GrainContact> contacts;
  for (GrainContact contact : simulation.contacts()) {
    contact.i = places[contact.i];
    if (contact.j >= 0 && (contact.j = places[contact.j]) < 0) continue;
    if (contact.i >= 0) contacts.push_back(contact);
  }
  return contacts;
}

/// Places among the bonds of a scene of those of another one; both lists are numbers in the run, ascending.
std::vector<std::int32_t> bond_origins(const std::vector<std::size_t>& before, const std::vector<std::size_t>& now) {
  std::vector<std::int32_t> origins;
  for (const std::size_t bond : now) {
    const auto at = std::ranges::lower_bound(before, bond);
    origins.push_back(at != before.end() && *at == bond ? static_cast<std::int32_t>(at - before.begin()) : -1);
  }
  return origins;
}

}  // namespace

StagedSimulation::Start StagedSimulation::start_of_first() const {
  const GrainScene& scene = stages_.front().scene;
  Start start{.walls = {}, .bodies = {std::vector<std::size_t>(scene.grains.size()), scene.grains}, .cell = scene.cell};
  std::iota(start.bodies.numbers.begin(), start.bodies.numbers.end(), std::size_t{0});
  return start;
}

StagedSimulation::Bonds StagedSimulation::bonds_at_start() const {
  const GrainScene& scene = stages_.front().scene;
  Bonds bonds{scene.bonds, scene.strengths, {}};
  for (GrainBond& bond : bonds.all)
    if (!bond.rest) bond.rest = rest_of(scene, bond.i, bond.j);
  return bonds_of(0, std::move(bonds), start_of_first(), {});
}

StagedSimulation::Bonds StagedSimulation::bonds_of(std::size_t stage, Bonds bonds, const Start& start,
                                                   std::span<const GrainContact> contacts) const {
  if (!stages_[stage].bonds) return bonds;
  const PresentBodies& bodies = start.bodies;
  const StageBonds& how = *stages_[stage].bonds;
  GrainScene scene;
  scene.grains = bodies.grains;
  scene.cell = start.cell;
  scene.bonds = make_bonds(scene, contacts, bonds_between(bodies.numbers, bonds).bonds, how);
  if (how.strengths) {
    const ContactStrengths made = bond_strengths(scene, *how.strengths);
    if (!bonds.strengths) bonds.strengths.emplace().friction = made.friction;
    bonds.strengths->tension.insert(bonds.strengths->tension.end(), made.tension.begin(), made.tension.end());
    bonds.strengths->shear.insert(bonds.strengths->shear.end(), made.shear.begin(), made.shear.end());
  }
  for (GrainBond& bond : scene.bonds) bond.i = bodies.numbers[bond.i], bond.j = bodies.numbers[bond.j];
  bonds.all.insert(bonds.all.end(), scene.bonds.begin(), scene.bonds.end());
  bonds.stages.insert(bonds.stages.end(), scene.bonds.size(), stage);
  return bonds;
}

StagedSimulation::SceneBonds StagedSimulation::bonds_between(const std::vector<std::size_t>& bodies,
                                                             const Bonds& bonds) {
  SceneBonds found;
  const auto place = [&](std::size_t number) {
    return static_cast<std::size_t>(std::ranges::lower_bound(bodies, number) - bodies.begin());
  };
  for (std::size_t b = 0; b < bonds.all.size(); ++b) {
    GrainBond bond = bonds.all[b];
    const std::size_t i = place(bond.i), j = place(bond.j);
    if (i == bodies.size() || j == bodies.size() || bodies[i] != bond.i || bodies[j] != bond.j) continue;
    bond.i = i, bond.j = j;
    found.numbers.push_back(b);
    found.bonds.push_back(bond);
  }
  return found;
}

std::size_t StagedSimulation::first_added(std::size_t stage) const {
  std::size_t number = stages_.front().scene.grains.size();
  for (std::size_t k = 0; k < stage; ++k) number += stages_[k].bodies.added.size();
  return number;
}

const Grain& StagedSimulation::body_of_run(std::size_t number) const {
  if (number < stages_.front().scene.grains.size()) return stages_.front().scene.grains[number];
  std::size_t stage = 0;
  while (number >= first_added(stage + 1)) ++stage;
  return stages_[stage].bodies.added[number - first_added(stage)];
}

/// The stage that gave the servo of a wall its schedule.
std::size_t StagedSimulation::stage_of_servo(std::size_t stage, std::size_t wall) const {
  for (; stage > 0 && stages_[stage].scene.walls[wall].servo->goes_on; --stage) {
    const std::int32_t before = wall_origins(stage)[wall];
    if (before < 0) break;
    wall = static_cast<std::size_t>(before);
  }
  return stage;
}

/// Likewise of a stress of the cell.
std::size_t StagedSimulation::stage_of_stress(std::size_t stage, bool CellServo::*goes_on) const {
  while (stage > 0 && (*stages_[stage].scene.cell->servo).*goes_on) --stage;
  return stage;
}

/// The scene of a stage.
/// \param firsts steps with which the stages up to this one begin
GrainScene StagedSimulation::scene_of(std::span<const std::int64_t> firsts, const Start& start,
                                      const Bonds& bonds) const {
  const std::size_t stage = firsts.size() - 1;
  const auto time_of = [&](std::size_t k) { return static_cast<double>(firsts[k]) * options_.time_step; };
  GrainScene scene = stages_[stage].scene;
  scene.grains = start.bodies.grains;
  const SceneBonds between = bonds_between(start.bodies.numbers, bonds);
  scene.bonds = between.bonds;
  scene.strengths.reset();
  if (bonds.strengths) {
    scene.strengths.emplace().friction = bonds.strengths->friction;
    for (const std::size_t bond : between.numbers) {
      scene.strengths->tension.push_back(bonds.strengths->tension[bond]);
      scene.strengths->shear.push_back(bonds.strengths->shear[bond]);
    }
  }
  const double time = time_of(stage);
  for (std::size_t w = 0; w < start.walls.size(); ++w) {
    Wall& wall = scene.walls[w];
    wall.end += start.walls[w] - wall.point;
    wall.point = start.walls[w];
    wall.move_x = delayed(wall.move_x, time);
    wall.move_y = delayed(wall.move_y, time);
    if (wall.servo) wall.servo->wanted = delayed(wall.servo->wanted, time_of(stage_of_servo(stage, w)));
  }
  if (!scene.cell) return scene;
  PeriodicCell& cell = *scene.cell;
  cell.corner = start.cell->corner;
  cell.width = start.cell->width, cell.height = start.cell->height, cell.shift = start.cell->shift;
  for (Schedule* rate : {&cell.rate_xx, &cell.rate_yy, &cell.rate_xy}) *rate = delayed(*rate, time);
  if (cell.servo)
    for (const auto& [stress, goes_on] : {std::pair{&cell.servo->stress_xx, &CellServo::goes_on_xx},
                                          std::pair{&cell.servo->stress_yy, &CellServo::goes_on_yy}})
      if (*stress) *stress = delayed(**stress, time_of(stage_of_stress(stage, goes_on)));
  return scene;
}

/// The number of each wall of a stage in the stage before; -1: it is new.
std::vector<std::int32_t> StagedSimulation::wall_origins(std::size_t stage) const {
  const std::vector<std::string> before = names_of(stages_[stage - 1].scene.walls);
  std::vector<std::int32_t> origins;
  for (const Wall& wall : stages_[stage].scene.walls) {
    const auto renamed = std::ranges::find(stages_[stage].renamed_walls, wall.name, &WallRenaming::to);
    const std::string& name = renamed == stages_[stage].renamed_walls.end() ? wall.name : renamed->from;
    const auto at = std::ranges::find(before, name);
    origins.push_back(at == before.end() ? -1 : static_cast<std::int32_t>(at - before.begin()));
  }
  return origins;
}

/// The places of the walls of a stage that follows the present one.
std::vector<Vec2> StagedSimulation::places_in(std::size_t stage) const {
  const std::vector<WallState> standing = present_->walls();
  const std::vector<std::int32_t> origins = wall_origins(stage);
  std::vector<Vec2> places;
  for (std::size_t w = 0; w < origins.size(); ++w)
    places.push_back(origins[w] < 0 ? stages_[stage].scene.walls[w].point : standing[origins[w]].place);
  return places;
}

void StagedSimulation::begin_stage() {
  const EnergyLedger before = energy();
  const std::size_t next = number() + 1;
  const StageBodies& how = stages_[next].bodies;
  Start start{.walls = places_in(next), .bodies = {}, .cell = present_->placed_cell()};
  if (const auto cell = present_->cell()) start.strain = cell->strain;
  ChangedBodies changed;
  Bonds bonds;
  std::unique_ptr<GrainSimulation> simulation;
  std::vector<std::int64_t> firsts;
  for (const StageReport& report : reports_) firsts.push_back(report.first);
  firsts.push_back(step());
  try {
    changed = change_bodies({numbers(), present_->grains()}, how, first_added(next));
    start.bodies = changed.now;
    const std::vector<GrainContact> contacts = contacts_now(*present_, changed.origins);
    bonds = bonds_of(next, bonds_, start, contacts);
    simulation = std::make_unique<GrainSimulation>(scene_of(firsts, start, bonds), options_,
                                                   order_now(present_->order(), changed.origins));
    simulation->take_over(*present_, {changed.origins,
                                      bond_origins(bonds_between(numbers(), bonds_).numbers,
                                                   bonds_between(start.bodies.numbers, bonds).numbers),
                                      wall_origins(next)});
  } catch (const Error& error) {
    throw error.at(stages_[next].where());
  }
  keep_past_breaks(start.bodies.numbers);
  reports_.push_back({.name = stages_[next].name,
                      .first = step(),
                      .last = step(),
                      .effects = active_effects(simulation->effects()),
                      .removed = changed.removed,
                      .renamed = changed.renamed,
                      .added = how.added.size(),
                      .bonds_made = bonds.all.size() - bonds_.all.size(),
                      .renamed_walls = stages_[next].renamed_walls,
                      .idle_removals = changed.idle_removals,
                      .idle_renamings = changed.idle_renamings});
  present_ = std::move(simulation);
  start_ = std::move(start);
  bonds_ = std::move(bonds);
  const EnergyLedger after = present_->energy();
  potential_ = before.potential;
  const double stored = before.kinetic + before.elastic(), change = after.kinetic + after.elastic() - stored;
  if (std::abs(change) > energy_rounding * stored) changes_ += change;
}

/// Breaks of bonds whose bodies go.
void StagedSimulation::keep_past_breaks(const std::vector<std::size_t>& bodies_left) {
  const std::vector<BondBreak> all = breaks();
  const std::vector<std::size_t> left = bonds_between(bodies_left, bonds_).numbers;
  past_breaks_.clear();
  for (const BondBreak& event : all)
    if (!std::ranges::binary_search(left, event.bond)) past_breaks_.push_back(event);
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
