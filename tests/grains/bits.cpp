// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The bits of a run depend on its scene alone: not on threads, neighbour lists, the width of vectors, the order of
/// bodies, or where the run was saved; blocks of bodies change sums by rounding only.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "equidem/core/simd.hpp"
#include "equidem/grains/contacts/bonds.hpp"

#include "grains/bonded_scenes.hpp"
#include "grains/cell_scenes.hpp"
#include "grains/resuming.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct BitScene {
  std::string name;
  GrainScene scene;
  double step = 0.004;
  std::int64_t steps = 300;  ///< in cells so many that all bodies leave it more than once
};

GrainScene two_kinds(GrainScene scene) {
  PairProperties other = scene.pairs[0], same = scene.pairs[0];
  other.stiffness *= 2;
  other.restitution = 0.5;
  same.friction = 0.1;
  scene.kinds = 2;
  scene.pairs = {scene.pairs[0], other, other, same};
  for (std::size_t k = 0; k < scene.grains.size(); k += 3) scene.grains[k].kind = 1;
  return scene;
}

GrainScene without_friction(GrainScene scene) {
  scene.pairs[0].friction = 0;
  return scene;
}

GrainScene pressed_by_walls(GrainScene scene) {
  scene.walls[3].move_x = scene.walls[3].move_y = {};
  scene.walls[3].servo = Servo{.direction = {0, -1}, .wanted = {.value = 10}, .max_speed = 1};
  scene.walls[1].servo = Servo{.direction = {1, 0}, .wanted = {.value = 5}, .max_speed = 0.3, .mirror = "right"};
  return scene;
}

/// Bonds from k to k + `next`, for k in steps of `every`, where both are in one row of `rows`; strengths where tension
/// is given.
GrainScene tied(GrainScene scene, const GrainBond& like, std::size_t every, std::size_t next, std::size_t rows,
                double tension = 0) {
  for (std::size_t k = 0; k + next < scene.grains.size(); k += every) {
    if (next == 1 && k % rows == rows - 1) continue;
    scene.bonds.push_back(like);
    scene.bonds.back().i = k, scene.bonds.back().j = k + next;
  }
  if (tension > 0)
    scene.strengths = bond_strengths(
        scene, {.tension = tension, .shear = 0.67 * tension, .friction = 0.2, .weibull_modulus = 3.0, .seed = 3});
  return scene;
}

GrainScene sheared(GrainScene scene, double rate) {
  scene.cell->rate_xy = {.value = rate};
  scene.cell->servo = CellServo{.stress_yy = Schedule{.value = -5}, .max_rate = 0.1};
  return scene;
}

/// Every loop over contacts, bonds and images that the stepping has.
std::vector<BitScene> bit_scenes(const Stepping& stepping) {
  const NormalLaw law = stepping.law;
  const GrainScene box = busy_box(law, 5, 5, 80);
  std::vector<BitScene> scenes{
      {"discs", box}, {"two kinds", two_kinds(box)}, {"no friction", without_friction(busy_box(law, 5, 5, 83))}};
  if (!is_map(law)) scenes.push_back({"servo walls", pressed_by_walls(box)});
  if (law == NormalLaw::energy_map || gives_force(law))
    scenes.push_back({"chains", tied(busy_box(law, 5, 5, 31), all_of_a_bond, 1, 1, 5)});
  if (!gives_force(law)) return scenes;
  const GrainBond dashpots{.normal_dashpot = 3, .tangential_dashpot = 2, .rolling_dashpot = 0.1};
  const GrainBond springs{.normal_dashpot = 1, .normal_spring = 300, .tangential_spring = 150, .bending_spring = 12};
  scenes.push_back({"rolling and cohesion", with_effects(two_kinds(box))});
  scenes.push_back({"cohesion of bonded discs", with_effects(tied(busy_box(law, 8, 4, 31), springs, 1, 1, 4, 30))});
  scenes.push_back({"rolling and cohesion of shapes", with_effects(mixed_box(law, 5, 5, 85))});
  scenes.push_back({"shapes", mixed_box(law, 5, 5, 85)});
  scenes.push_back({"shapes without friction", without_friction(mixed_box(law, 5, 5, 73))});
  scenes.push_back({"needles", flying_needles(24, 33), 1e-3, 1200});
  scenes.push_back({"tied pairs", tied(busy_box(law, 6, 4, 81), dashpots, 2, 1, 4)});
  scenes.push_back({"bonds that break", tied(busy_box(law, 8, 4, 31), springs, 1, 1, 4, 30)});
  GrainScene bonded = tied(busy_cell(law, 5, 4, 6, 0.3), springs, 1, 4, 4, 12);
  for (Grain& grain : bonded.grains) grain.velocity = 4 * grain.velocity + Vec2{2, 1};
  GrainScene shapes = in_cell_of_its_size(mixed_box(law, 5, 4, 6), 5, 4, 2);
  shapes.pairs[0].stiffness *= 8;  // small discs of clumps are not pressed into others
  scenes.push_back({"cell", busy_cell(law, 5, 4, 6, 4), 0.004, 700});
  scenes.push_back({"cell of shapes", shapes, 0.001, 900});
  scenes.push_back({"cohesion in a cell", with_effects(shapes, 2), 0.001, 900});
  scenes.push_back({"cell of bonds that break", bonded, 0.002, 900});
  if (stepping.integrator != GrainIntegrator::velocity_verlet) return scenes;
  scenes.push_back({"sheared cell", sheared(busy_cell(law, 6, 5, 29), 3), 0.002, 1100});
  scenes.push_back({"sheared cell of shapes", sheared(shapes, 3), 0.001, 900});
  scenes.push_back({"rolling in a sheared cell", with_effects(sheared(busy_cell(law, 6, 5, 29), 3)), 0.002, 1100});
  bonded.cell->rate_xy = {.value = 2};
  for (std::vector<double>* strengths : {&bonded.strengths->tension, &bonded.strengths->shear})
    for (double& strength : *strengths) strength *= 3;
  scenes.push_back({"sheared cell of bonds", bonded, 0.002, 900});
  return scenes;
}

GrainOptions in_blocks(const Stepping& stepping, const BitScene& scene, std::size_t bodies) {
  GrainOptions options = options_of(stepping, scene.step);
  options.bodies_per_block = bodies;
  return options;
}

Bits bits_after(const BitScene& scene, const GrainOptions& options) {
  GrainSimulation simulation(scene.scene, options);
  simulation.advance(scene.steps);
  CHECK(simulation.counters().contacts > 10);  // otherwise nothing is shown
  if (scene.scene.strengths) CHECK(simulation.breaks().size() > 1);
  if (scene.scene.strengths) CHECK(simulation.breaks().size() < scene.scene.bonds.size());
  return bits_and_loads_of(simulation);
}

/// What comes k-th in the copy was order[k]-th.
template <class Item>
std::vector<Item> reordered(const std::vector<Item>& items, const std::vector<std::size_t>& order) {
  std::vector<Item> result;
  for (const std::size_t k : order) result.push_back(items[k]);
  return result;
}

std::vector<std::size_t> shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.rbegin(), order.rend(), std::size_t{0});
  if (seed == 0) return order;  // just the other way round
  Random random(seed);
  for (std::size_t k = count; k > 1; --k) std::swap(order[k - 1], order[random.below(k)]);
  return order;
}

/// Bodies, walls, clumps and their discs, and bonds in another order; every other bond from its other end.
GrainScene reordered(const GrainScene& scene, const std::vector<std::size_t>& bodies, std::uint64_t seed) {
  GrainScene other = scene;
  other.grains = reordered(scene.grains, bodies);
  other.walls = reordered(scene.walls, shuffled(scene.walls.size(), seed));
  std::reverse(other.clumps.begin(), other.clumps.end());
  for (Clump& clump : other.clumps) std::reverse(clump.discs.begin(), clump.discs.end());
  for (Grain& grain : other.grains)
    if (grain.clump >= 0) grain.clump = static_cast<int>(other.clumps.size()) - 1 - grain.clump;
  std::vector<std::size_t> place(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) place[bodies[k]] = k;
  const std::vector<std::size_t> bonds = shuffled(scene.bonds.size(), seed);
  other.bonds = reordered(scene.bonds, bonds);
  for (std::size_t b = 0; b < bonds.size(); ++b) {
    GrainBond& bond = other.bonds[b];
    bond.i = place[bond.i], bond.j = place[bond.j];
    if (b % 2 == 0) std::swap(bond.i, bond.j);
  }
  if (scene.strengths) other.strengths->tension = reordered(scene.strengths->tension, bonds);
  if (scene.strengths) other.strengths->shear = reordered(scene.strengths->shear, bonds);
  return other;
}

}  // namespace

TEST_CASE("threads_lists_found_at_other_times_and_wider_vectors_change_no_bit") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  for (const BitScene& scene : bit_scenes(stepping)) {
    for (const std::size_t bodies : {0, 3}) {
      GrainOptions options = in_blocks(stepping, scene, bodies);
      CAPTURE(stepping.name(), scene.name, bodies);
      const Bits chosen = bits_after(scene, options);
      for (const int threads : {1, 2, 3, 4}) {
        const ThreadsFor here(threads);
        CAPTURE(threads);
        CHECK(bits_after(scene, options) == chosen);
      }
      if (gives_force(stepping.law) && bodies == 0) {
        for (const VectorWidth widest : {VectorWidth::bits_128, VectorWidth::bits_256, VectorWidth::bits_512}) {
          allow_vectors_up_to(widest);
          CAPTURE(static_cast<int>(widest));
          CHECK(bits_after(scene, options) == chosen);
        }
      }
      for (const double margin : {1e-6, 0.01, 0.3, 6.0}) {
        options.margin = margin;
        CAPTURE(margin);
        CHECK(bits_after(scene, options) == chosen);
      }
    }
  }
}

TEST_CASE("blocks_change_sums_by_rounding_only") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  for (const BitScene& scene : bit_scenes(stepping)) {
    // dashpots of a disc with several bonds decay one after the other, block by block
    if (!scene.scene.bonds.empty() && scene.name != "tied pairs") continue;
    for (const std::size_t bodies : {1, 3, 8}) {
      GrainSimulation start(scene.scene, in_blocks(stepping, scene, 0));
      GrainSimulation divided(scene.scene, in_blocks(stepping, scene, bodies));
      start.advance(120);
      divided.advance(120);
      const EnergyLedger a = start.energy(), b = divided.energy();
      const double apart = distance_of(start.grains(), divided.grains());
      CAPTURE(stepping.name(), scene.name, bodies, apart, a.lost(), b.lost());
      if (scene.steps == 300) CHECK(start.counters().contacts > 5);
      CHECK(apart < 1e-10);
      CHECK(divided.counters().evaluations == start.counters().evaluations);
      CHECK(divided.counters().contacts == start.counters().contacts);
      CHECK(std::abs(a.lost() - b.lost()) < 1e-10 * a.largest());
      CHECK(std::abs(a.error() - b.error()) < 1e-10 * a.largest());
      CHECK(start.contacts().size() == divided.contacts().size());
    }
  }
}

TEST_CASE("the_order_of_bodies_walls_bonds_and_clumps_changes_no_bit") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  const std::uint64_t seed = GENERATE(0, 1, 2);
  for (const BitScene& scene : bit_scenes(stepping)) {
    if (scene.scene.cell) continue;
    const std::vector<std::size_t> bodies = shuffled(scene.scene.grains.size(), seed);
    const GrainOptions options = options_of(stepping, scene.step);
    GrainSimulation one(scene.scene, options), two(reordered(scene.scene, bodies, seed), options);
    for (int part = 0; part < 30; ++part) {
      one.advance(scene.steps / 30);
      two.advance(scene.steps / 30);
      const EnergyLedger a = one.energy(), b = two.energy();
      CAPTURE(stepping.name(), scene.name, seed, part, a.kinetic - b.kinetic, a.lost() - b.lost());
      REQUIRE(a.kinetic == b.kinetic);
      REQUIRE(a.lost_bond == b.lost_bond);
      REQUIRE(a.elastic_bond == b.elastic_bond);
      if (scene.scene.clumps.empty()) REQUIRE(a.error() == b.error());
      const std::vector<Grain> expected = reordered(one.grains(), bodies), found = two.grains();
      for (std::size_t k = 0; k < found.size(); ++k) {
        REQUIRE(found[k].position == expected[k].position);
        REQUIRE(found[k].velocity == expected[k].velocity);
        REQUIRE(found[k].spin == expected[k].spin);
        REQUIRE(found[k].angle == expected[k].angle);
      }
      REQUIRE(two.contacts().size() == one.contacts().size());
    }
    CHECK(one.counters().contacts > 10);
  }
}

TEST_CASE("a_run_saved_at_any_step_goes_on_with_the_same_bits") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  for (const BitScene& scene : bit_scenes(stepping)) {
    CAPTURE(stepping.name(), scene.name);
    check_resuming(scene.scene, in_blocks(stepping, scene, 3), scene.steps);
  }
}

TEST_CASE("a_state_of_another_scene_or_with_contacts_that_the_scene_lacks_is_refused_and_leaves_the_present_one") {
  const auto refused = [](GrainSimulation& simulation, const SavedState& damaged,
                          const std::vector<std::string>& words) {
    const Bits before = bits_of(simulation);
    check_refused([&] { simulation.restore(damaged); }, words);
    CHECK(bits_of(simulation) == before);
  };
  const GrainOptions options = options_of(NormalLaw::linear_dashpot, 0.01);
  GrainSimulation simulation(busy_box(NormalLaw::linear_dashpot, 3, 3, 22), options);
  GrainSimulation fewer(busy_box(NormalLaw::linear_dashpot, 3, 2, 1), options);
  simulation.advance(40);
  refused(fewer, simulation.save(), {"the state is of 9 grains", "the scene has 6"});
  SavedState damaged = fewer.save();
  damaged["contacts"].push_back(1);
  refused(fewer, damaged, {});
  REQUIRE(!simulation.save()["contacts"].empty());
  for (const double body : {-1.0, 9.0, 0.5, 1e300, std::nan("")}) {
    damaged = simulation.save();
    damaged["contacts"][0] = body;
    CAPTURE(body);
    refused(simulation, damaged, {});
  }
  GrainSimulation in_cell(busy_cell(NormalLaw::linear_dashpot, 6, 5, 5), verlet_options());
  in_cell.advance(100);
  constexpr std::size_t periods_along_x = 13;
  damaged = in_cell.save();
  REQUIRE(damaged["contacts"].size() > periods_along_x);
  damaged["contacts"][periods_along_x] += 1;
  refused(in_cell, damaged, {"an image that is far away"});
}
