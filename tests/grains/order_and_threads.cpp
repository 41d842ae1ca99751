// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Results are bit-identical for every order of the bodies, number of threads and margin of the neighbour lists.
#include <numeric>

#include "equidem/core/threads.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr std::int64_t steps = 300;

Bits bits_after_run(const GrainScene& scene, const GrainOptions& options) {
  GrainSimulation simulation(scene, options);
  simulation.advance(steps);
  CHECK(simulation.counters().contacts > 20);  // otherwise nothing is shown
  return bits_of(simulation);
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

}  // namespace

TEST_CASE("the_order_of_bodies_and_walls_changes_no_bit") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  const std::uint64_t seed = GENERATE(0, 1, 2);
  const GrainScene scene = busy_box(stepping.law, 4, 4, 11);
  GrainScene other = scene;
  const std::vector<std::size_t> grains = shuffled(scene.grains.size(), seed);
  const std::vector<std::size_t> walls = shuffled(scene.walls.size(), seed);
  other.grains = reordered(scene.grains, grains);
  other.walls = reordered(scene.walls, walls);

  GrainSimulation one(scene, options_of(stepping, 0.005));
  GrainSimulation two(other, options_of(stepping, 0.005));
  for (int k = 0; k < 300; ++k) {
    one.advance(1);
    two.advance(1);
    // the ledger is a sum over all bodies; the motions are compared below
    const EnergyLedger a = one.energy(), b = two.energy();
    CAPTURE(stepping.name(), seed, k, a.kinetic - b.kinetic, a.lost() - b.lost());
    REQUIRE(a.kinetic == b.kinetic);
    REQUIRE(a.error() == b.error());
  }
  CHECK(one.counters().contacts > 20);
  const std::vector<Grain> expected = reordered(one.grains(), grains);
  const std::vector<Grain> found = two.grains();
  for (std::size_t k = 0; k < found.size(); ++k) {
    CAPTURE(stepping.name(), seed, k);
    CHECK(found[k].position == expected[k].position);
    CHECK(found[k].velocity == expected[k].velocity);
    CHECK(found[k].spin == expected[k].spin);
    CHECK(found[k].angle == expected[k].angle);
  }
  CHECK(two.contacts().size() == one.contacts().size());
}

TEST_CASE("the_margin_of_the_neighbour_lists_changes_no_bit") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  const GrainScene scene = busy_box(stepping.law, 4, 4, 12);
  GrainOptions options = options_of(stepping, 0.005);
  const Bits chosen = bits_after_run(scene, options);
  for (const double margin : {1e-6, 0.01, 0.3, 10.0}) {
    options.margin = margin;
    CAPTURE(stepping.name(), margin);
    CHECK(bits_after_run(scene, options) == chosen);
  }
}

TEST_CASE("the_number_of_threads_changes_no_bit_of_a_motion") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  const GrainScene scene = busy_box(stepping.law, 4, 4, 13);
  const int before = thread_count();
  std::vector<Bits> bits;
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    bits.push_back(bits_after_run(scene, options_of(stepping, 0.005)));
  }
  set_thread_count(before);
  CAPTURE(stepping.name());
  CHECK(bits[1] == bits[0]);
  CHECK(bits[2] == bits[0]);
}
