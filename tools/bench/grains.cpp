// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Speed of the loop of colliding discs: a box of discs with friction, settled, and flowing after gravity is tilted.
#include <cmath>
#include <numbers>

#include <CLI/CLI.hpp>

#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/grains/grain_simulation.hpp"

#include "bench.hpp"

namespace equidem::bench {
namespace {

constexpr double step = 1.5e-5, gravity = 9.81, tilt = 40 * std::numbers::pi / 180;
constexpr double width_of_3000 = 1.215;

PairProperties contact(double friction) {
  return {
      .stiffness = 1e5, .restitution = 0.4, .friction = friction, .tangential_ratio = 0.8, .tangential_damping = 0.1};
}

/// Discs of radius 0.5 to 1 cm, each in its own square of a loose lattice, above the floor of a box without a lid.
GrainScene loose_discs(std::size_t count, bool friction) {
  const double spacing = 0.0205, width = width_of_3000 * std::sqrt(static_cast<double>(count) / 3000);
  const auto columns = static_cast<std::size_t>(width / spacing);
  Random random(7);
  GrainScene scene;
  for (std::size_t k = 0; k < count; ++k) {
    const double radius = random.uniform(0.005, 0.01), room = 0.01 - radius;
    const double mass = 25 * std::numbers::pi * radius * radius;
    const double x = (static_cast<double>(k % columns) + 0.5) * spacing + random.uniform(-room, room);
    const double y = (static_cast<double>(k / columns) + 0.5) * spacing + random.uniform(-room, room);
    scene.grains.push_back({.position = {x, y}, .radius = radius, .inertia = {mass, 0.5 * mass * radius * radius}});
  }
  scene.walls = box_walls(width);
  for (Wall& wall : scene.walls) wall.kind = 1;
  scene.gravity = {0, -gravity};
  scene.kinds = 2;
  const PairProperties grains = contact(friction ? 0.17 : 0), walls = contact(friction ? 0.25 : 0);
  scene.pairs = {grains, walls, walls, walls};
  return scene;
}

/// Adds a row.
/// \return the bodies at the end
std::vector<Grain> measure(TextTable& table, const char* state, const GrainScene& scene, std::int64_t before,
                           std::int64_t steps, int rounds) {
  const GrainOptions options{.law = NormalLaw::linear_dashpot, .time_step = step};
  GrainSimulation simulation(scene, options);
  simulation.advance(before);
  const Entry entries[] = {entry_of("steps", simulation)};
  const GrainCounters start = simulation.counters();
  const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
  const GrainCounters end = simulation.counters();
  const auto bodies = static_cast<double>(scene.grains.size());
  const double made = static_cast<double>(steps) * (rounds + 1),
               nanoseconds = 1e9 / (bodies * static_cast<double>(steps));
  table.add("{} & {} & {:.3g} & {} & {:.2f} & {:.1f} & {:.0f}", scene.grains.size(), state,
            1e9 / (range_of(seconds[0]).median * nanoseconds), (range_of(seconds[0]) * nanoseconds).text("{:.1f}"),
            static_cast<double>(end.evaluations - start.evaluations) / made / bodies,
            1000 * static_cast<double>(end.rebuilds - start.rebuilds) / made, simulation.bytes_per_body());
  return simulation.grains();
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem;
  using namespace equidem::bench;
  std::vector<std::size_t> sizes{3000, 20000};
  int rounds = 5;
  double work = 6e6, settle = 1.2;
  return run_benchmark(
      "bench_grains", "Speed of the loop of colliding discs", argc, argv,
      [&](CLI::App& app) {
        app.add_option("--discs", sizes, "numbers of discs");
        declare_rounds(app, rounds);
        app.add_option("--work", work, "discs times steps in each measurement");
        app.add_option("--settle", settle, "time for 3000 discs to fall and come to rest, s");
      },
      [&](Report& report) {
        set_thread_count(1);
        report.begin("The loop of colliding discs");
        TextTable table(
            "discs & state & disc-steps/s & ns & contacts per disc & new lists per 1000 steps & bytes per disc");
        for (const std::size_t size : sizes) {
          const auto steps = static_cast<std::int64_t>(work / static_cast<double>(size));
          const double time = settle * std::pow(static_cast<double>(size) / 3000, 0.25);
          for (const bool friction : {true, false}) {
            GrainScene scene = loose_discs(size, friction);
            scene.grains = measure(table, friction ? "settled" : "settled, no friction", scene,
                                   static_cast<std::int64_t>(time / step), steps, rounds);
            scene.gravity = {gravity * std::sin(tilt), -gravity * std::cos(tilt)};
            measure(table, friction ? "flowing" : "flowing, no friction", scene, 2000, steps, rounds);
          }
        }
        report.add(
            "\nDiscs of radius 0.5 to 1 cm in a box, linear spring and dashpot, friction 0.17 (walls 0.25) with a "
            "tangential spring; \"flowing\": gravity tilted by 40 degrees. One thread, processor time; medians "
            "(smallest .. largest) of rounds. Bytes are those of all arrays of the simulation.\n\n" +
            table.markdown());
      });
}
