// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies in blocks, on which threads work at the same time: the bits depend neither on threads nor on neighbour lists,
/// and blocks change sums in their last digits only.
#include <cmath>
#include <string>
#include <vector>

#include "grains/bonded_scenes.hpp"
#include "grains/cell_scenes.hpp"
#include "grains/resuming.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

double distance_of_motions(const GrainSimulation& a, const GrainSimulation& b) {
  const std::vector<Grain> here = a.grains(), there = b.grains();
  double largest = 0;
  for (std::size_t k = 0; k < std::min(here.size(), there.size()); ++k) {
    largest = std::max({largest, norm(here[k].position - there[k].position), norm(here[k].velocity - there[k].velocity),
                        std::abs(here[k].spin - there[k].spin), std::abs(here[k].angle - there[k].angle)});
  }
  return largest;
}

/// Pairs of discs side by side, tied two by two, which fall on one another.
GrainScene box_of_tied_pairs(const Stepping& stepping) {
  GrainScene scene = busy_box(stepping.law, 6, 4, 81);
  for (std::size_t k = 0; k + 4 < scene.grains.size(); k += 8) {
    scene.bonds.push_back({.i = k, .j = k + 4, .normal_dashpot = 3, .tangential_dashpot = 2});
    scene.bonds.push_back({.i = k + 1, .j = k + 5, .normal_dashpot = 1, .normal_spring = 5});
  }
  return scene;
}

GrainScene box_of_two_kinds(const Stepping& stepping) {
  GrainScene scene = busy_box(stepping.law, 5, 5, 82);
  PairProperties other = scene.pairs[0];
  other.friction = 0.1;
  scene.kinds = 2;
  scene.pairs = {scene.pairs[0], other, other, scene.pairs[0]};
  for (std::size_t k = 0; k < scene.grains.size(); k += 3) scene.grains[k].kind = 1;
  return scene;
}

GrainScene smooth_box(const Stepping& stepping) {
  GrainScene scene = busy_box(stepping.law, 5, 5, 83);
  scene.pairs[0].friction = 0;
  return scene;
}

struct BlockScene {
  std::string name;
  GrainScene scene;
};

std::vector<BlockScene> block_scenes(const Stepping& stepping) {
  std::vector<BlockScene> scenes{{"discs", busy_box(stepping.law, 5, 5, 80)},
                                 {"two kinds", box_of_two_kinds(stepping)},
                                 {"no friction", smooth_box(stepping)}};
  if (!gives_force(stepping.law)) return scenes;
  scenes.push_back({"shapes", mixed_box(stepping.law, 5, 5, 85)});
  scenes.push_back({"needles", flying_needles(24, 86)});
  scenes.push_back({"tied pairs", box_of_tied_pairs(stepping)});
  scenes.push_back({"cell", busy_cell(stepping.law, 5, 5, 87)});
  if (stepping.integrator != GrainIntegrator::velocity_verlet) return scenes;
  scenes.push_back({"sheared cell", busy_cell(stepping.law, 5, 5, 88)});
  scenes.back().scene.cell->rate_xy = {.value = 0.5};
  return scenes;
}

GrainOptions in_blocks(const Stepping& stepping, std::size_t bodies) {
  GrainOptions options = options_of(stepping, 0.004);
  options.bodies_per_block = bodies;
  return options;
}

}  // namespace

TEST_CASE("threads_that_share_blocks_change_no_bit") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  for (const auto& [name, scene] : block_scenes(stepping)) {
    std::vector<Bits> bits;
    for (const int threads : {1, 2, 3, 4}) {
      const ThreadsFor here(threads);
      GrainSimulation simulation(scene, in_blocks(stepping, 3));
      simulation.advance(300);
      CAPTURE(stepping.name(), name, threads);
      CHECK(simulation.counters().contacts > 10);
      bits.push_back(bits_of(simulation));
      CHECK(bits.back() == bits.front());
    }
  }
}

TEST_CASE("blocks_change_sums_by_rounding_only") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  for (const auto& [name, scene] : block_scenes(stepping)) {
    for (const std::size_t bodies : {1, 3, 8}) {
      GrainSimulation start(scene, in_blocks(stepping, 0)), divided(scene, in_blocks(stepping, bodies));
      start.advance(120);
      divided.advance(120);
      const EnergyLedger a = start.energy(), b = divided.energy();
      CAPTURE(stepping.name(), name, bodies, distance_of_motions(start, divided), a.lost(), b.lost());
      CHECK(start.counters().contacts > 5);
      CHECK(distance_of_motions(start, divided) < 1e-10);
      CHECK(divided.counters().evaluations == start.counters().evaluations);
      CHECK(divided.counters().contacts == start.counters().contacts);
      CHECK(std::abs(a.lost() - b.lost()) < 1e-10 * a.largest());
      CHECK(std::abs(a.error() - b.error()) < 1e-10 * a.largest());
      CHECK(start.contacts().size() == divided.contacts().size());
    }
  }
}

TEST_CASE("lists_found_at_other_times_change_no_bit_of_blocks") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  for (const auto& [name, scene] : block_scenes(stepping)) {
    std::vector<Bits> bits;
    for (const double margin : {0.0, 1e-6, 0.01, 0.3}) {
      GrainOptions options = in_blocks(stepping, 4);
      options.margin = margin;
      GrainSimulation simulation(scene, options);
      simulation.advance(300);
      CAPTURE(stepping.name(), name, margin);
      bits.push_back(bits_of(simulation));
      CHECK(bits.back() == bits.front());
    }
  }
}

TEST_CASE("blocks_saved_at_any_step_go_on_with_the_same_bits") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  for (const auto& [name, scene] : block_scenes(stepping)) {
    CAPTURE(stepping.name(), name);
    if (name == "needles") continue;  // they seldom meet in few steps
    GrainOptions options = in_blocks(stepping, 3);
    options.time_step = 0.01;
    check_resuming(scene, options, 90);
  }
}
