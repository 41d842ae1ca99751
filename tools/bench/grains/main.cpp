// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Speed of the loop of colliding discs: a box of discs with friction, settled, and flowing after gravity is tilted.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/grains/grain_simulation.hpp"

#include "processor_time.hpp"

namespace equidem::bench {
namespace {

constexpr double step = 1.5e-5, gravity = 9.81, tilt = 40;
constexpr double width_of_3000 = 1.215;

PairProperties contact(double friction) {
  PairProperties pair;
  pair.stiffness = 1e5;
  pair.restitution = 0.4;
  pair.friction = friction;
  pair.tangential_ratio = 0.8;
  pair.tangential_damping = 0.1;
  return pair;
}

/// Discs of radius 0.5 .. 1 cm, each in its own square of a loose lattice, above the floor of a box without a lid.
GrainScene loose_discs(std::size_t count, bool friction, bool single) {
  const double spacing = 0.0205, width = width_of_3000 * std::sqrt(static_cast<double>(count) / 3000);
  const auto columns = static_cast<std::size_t>(width / spacing);
  Random random(7);
  GrainScene scene;
  for (std::size_t k = 0; k < count; ++k) {
    const double radius = random.uniform(0.005, 0.01), room = 0.01 - radius;
    Grain grain;
    grain.radius = radius;
    const double mass = 25 * std::numbers::pi * radius * radius;
    grain.inertia = {mass, 0.5 * mass * radius * radius};
    grain.position = {(static_cast<double>(k % columns) + 0.5) * spacing + random.uniform(-room, room),
                      (static_cast<double>(k / columns) + 0.5) * spacing + random.uniform(-room, room)};
    scene.grains.push_back(grain);
  }
  const auto wall = [](Vec2 point, Vec2 normal) {
    Wall line;
    line.point = point;
    line.normal = normal;
    line.kind = 1;
    return line;
  };
  scene.walls = {wall({0, 0}, {0, 1}), wall({0, 0}, {1, 0}), wall({width, 0}, {-1, 0})};
  scene.gravity = {0, -gravity};
  scene.kinds = 2;
  const PairProperties grains = contact(friction ? 0.17 : 0), walls = contact(friction ? 0.25 : 0);
  scene.pairs = {grains, walls, walls, walls};
  if (single) {
    // a kind that no body is of, and whose contacts slide always: with it contacts are computed one by one
    PairProperties sliding = contact(0.1);
    sliding.tangential_ratio = sliding.tangential_damping = 0;
    scene.kinds = 3;
    scene.pairs = {grains, walls, sliding, walls, walls, sliding, sliding, sliding, sliding};
  }
  return scene;
}

void report(const char* state, GrainScene scene, GrainScene* end, std::int64_t before, std::int64_t steps, int rounds) {
  GrainOptions options;
  options.law = NormalLaw::linear_dashpot;
  options.time_step = step;
  GrainSimulation simulation(scene, options);
  simulation.advance(before);
  std::vector<double> rates;
  const GrainCounters start = simulation.counters();
  for (int round = 0; round < rounds; ++round) {
    const double begin = processor_time();
    simulation.advance(steps);
    rates.push_back(static_cast<double>(scene.grains.size()) * static_cast<double>(steps) / (processor_time() - begin));
  }
  std::sort(rates.begin(), rates.end());
  const double made = static_cast<double>(steps) * rounds;
  const double bodies = static_cast<double>(scene.grains.size());
  std::printf("| %zu | %s | %.3g (%.3g .. %.3g) | %.1f | %.2f | %.1f | %.0f |\n", scene.grains.size(), state,
              rates[rates.size() / 2], rates.front(), rates.back(), 1e9 / rates[rates.size() / 2],
              static_cast<double>(simulation.counters().evaluations - start.evaluations) / made / bodies,
              1000 * static_cast<double>(simulation.counters().rebuilds - start.rebuilds) / made,
              simulation.bytes_per_body());
  std::fflush(stdout);
  if (end != nullptr) end->grains = simulation.grains();
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem;
  using namespace equidem::bench;
  CLI::App app("Speed of the loop of colliding discs");
  std::vector<std::size_t> sizes{3000, 20000};
  int rounds = 5;
  double work = 6e6, settle = 1.2;
  app.add_option("--discs", sizes, "numbers of discs");
  app.add_option("--rounds", rounds, "measurements; the median is reported");
  app.add_option("--work", work, "discs times steps in each measurement");
  app.add_option("--settle", settle, "time for 3000 discs to fall and come to rest, s");
  bool single = false;
  app.add_flag("--single", single, "compute contacts one by one, as with laws that the packed loop does not have");
  CLI11_PARSE(app, argc, argv);
  set_thread_count(1);
  std::printf(
      "| discs | state | disc steps/s | ns | contacts per disc | new lists per 1000 steps | bytes per disc |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const std::size_t size : sizes) {
    const auto steps = static_cast<std::int64_t>(work / static_cast<double>(size));
    for (const bool friction : {true, false}) {
      GrainScene scene = loose_discs(size, friction, single);
      const double time = settle * std::pow(static_cast<double>(size) / 3000, 0.25);
      report(friction ? "settled" : "settled, no friction", scene, &scene, static_cast<std::int64_t>(time / step),
             steps, rounds);
      const double angle = tilt * std::numbers::pi / 180;
      scene.gravity = {gravity * std::sin(angle), -gravity * std::cos(angle)};
      report(friction ? "flowing" : "flowing, no friction", scene, nullptr, 2000, steps, rounds);
    }
  }
  return 0;
}
